// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/expression.h"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <muParser.h>

#include "domewarp/core/errors.h"
#include "random_expression.h"
#include "reference_curves.h"

namespace domewarp {
namespace {

double muparser_value(const std::string& text, double r) try {
  mu::Parser parser;
  parser.DefineConst("pi", 3.14159265358979323846);
  parser.DefineConst("e", 2.71828182845904523536);
  parser.DefineFun("pow", static_cast<double (*)(double, double)>(std::pow));
  parser.DefineVar("r", &r);
  parser.SetExpr(text);
  return parser.Eval();
} catch (const mu::Parser::exception_type& error) {
  ADD_FAILURE() << text << ": " << error.GetMsg();
  return 0;
}

std::string complaint(const std::string& text) {
  try {
    compile(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    return error.what();
  }
  return "";
}

Real reference_slope(const ReferenceCurve& curve, double r) {
  const Real step("1e-20");
  return (curve.value(Real(r) + step) - curve.value(Real(r) - step)) / (Real(2) * step);
}

Real reference_second(const ReferenceCurve& curve, double r) {
  const Real step("1e-15");
  return (curve.value(Real(r) + step) - Real(2) * curve.value(Real(r)) + curve.value(Real(r) - step)) / (step * step);
}

void expect_close(double value, double expected, double tolerance, const std::string& what) {
  EXPECT_LE(std::abs(value - expected), tolerance * std::max(1.0, std::abs(expected))) << what;
}

TEST(Expression, AgreesWithMuParserOnRandomExpressions) {
  std::mt19937_64 random(20240611);
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string text = random_text(random, 4);
    const Expression expression = compile(text);
    const double r = std::uniform_real_distribution<double>(0.1, 1.7)(random);
    const double value = evaluate(expression, r), expected = muparser_value(text, r);
    if (!std::isfinite(expected) || std::abs(expected) > 1e6) continue;
    const Jet<double> jet = differentiate(expression, r);
    // Where the value moves by much within an ulp of r, so may two ways to round.
    if (!(std::abs(jet.d) < 1e6)) continue;
    // muParser's min and max drop a NaN, ours keep it: no curve is defined where a part of it is not.
    if (std::isnan(value) && text.find('m') != std::string::npos) continue;
    EXPECT_EQ(jet.v, value) << text;
    expect_close(value, expected, 1e-11, text + " at " + std::to_string(r));
    ++compared;
  }
  EXPECT_GT(compared, 1500);
}

TEST(Expression, ValuesAgreeWithSixtyDigits) {
  for (const ReferenceCurve& curve : reference_curves()) {
    const Expression expression = compile(curve.text);
    for (int i = 0; i <= 1000; ++i) {
      const double r = curve.end * i / 1000;
      expect_close(evaluate(expression, r), static_cast<double>(curve.value(r)), 2e-15, curve.text);
    }
  }
}

// @return error / bound: more than 1 is wrong
double rounding_over_bound(const Expression& expression, const Expression& truth, double r) {
  const Rounded value = evaluate_rounded(expression, r);
  EXPECT_TRUE(value.v == evaluate(expression, r) || std::isnan(value.v));
  const Quad exact = differentiate(truth, Quad(r)).v;
  if (!isfinite(exact) || !std::isfinite(value.v) || !std::isfinite(value.e)) return 0;
  const double error = static_cast<double>(abs(exact - Quad(value.v)));
  return error == 0 ? 0 : error / value.e;
}

TEST(Expression, TheBoundOfItsRoundingHolds) {
  for (const ReferenceCurve& curve : reference_curves()) {
    const Expression expression = compile(curve.text);
    for (int i = 1; i <= 20000; ++i) {
      const double r = curve.end * i / 20001;
      ASSERT_LE(rounding_over_bound(expression, expression, r), 1) << curve.text << " at " << r;
      EXPECT_LT(evaluate_rounded(expression, r).e, 1e-14 * (1 + std::abs(differentiate(expression, r).d))) << curve.text << " at " << r;
    }
  }
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(0, 2);
  int finite = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string text = random_text(random, 1 + i % 4);
    const Expression expression = compile(text);
    for (int k = 0; k < 5; ++k) {
      const double r = uniform(random);
      ASSERT_LE(rounding_over_bound(expression, expression, r), 1) << text << " at " << r;
      finite += std::isfinite(evaluate_rounded(expression, r).e);
    }
  }
  EXPECT_GT(finite, 30000);
}

TEST(Expression, TheBoundOfItsRoundingNoticesALastDigit) {
  EXPECT_GT(rounding_over_bound(compile("1-1.000000000000002r^2"), compile("1-r^2"), 0.9), 1);
}

TEST(Expression, DerivativesAgreeWithDifferencesInSixtyDigits) {
  for (const ReferenceCurve& curve : reference_curves()) {
    const Expression expression = compile(curve.text);
    for (int i = 1; i < 500; ++i) {
      const double r = curve.end * i / 500;
      const Jet<double> jet = differentiate(expression, r);
      expect_close(jet.v, evaluate(expression, r), 0, curve.text);
      if (std::abs(r - curve.kink) < 1e-10) continue;
      expect_close(jet.d, static_cast<double>(reference_slope(curve, r)), 3e-13, curve.text);
      expect_close(jet.dd, static_cast<double>(reference_second(curve, r)), 1e-12, curve.text);
    }
  }
}

TEST(Expression, DifferencesInSixtyDigitsWouldCatchAWrongDerivative) {
  const ReferenceCurve& curve = reference_curves().front();
  EXPECT_GT(
      std::abs(differentiate(compile("1-1.0000001r^2"), 0.5).d - static_cast<double>(reference_slope(curve, 0.5))),
      3e-13);
}

TEST(Expression, EveryFunctionHasItsDerivatives) {
  static const char* texts[] = {"sqrt(r)",    "exp(r)",  "ln(r)",   "log(r)",     "log10(r)",   "sin(r)",
                                "cos(r)",     "tan(r)",  "asin(r)", "acos(r)",    "atan(r)",    "sinh(r)",
                                "cosh(r)",    "tanh(r)", "abs(r)",  "min(r^3,2)", "max(r^3,0)", "pow(r,3)",
                                "pow(r,2.5)", "r^r",     "r^-2",    "2^r",        "1/tan(r)",   "(r+1)/(r+2)"};
  for (const char* text : texts) {
    const Expression expression = compile(text);
    for (const double r : {0.2, 0.5, 0.8}) {
      const double h = 1e-3;
      const auto f = [&](int k) { return evaluate(expression, r + k * h); };
      const Jet<double> jet = differentiate(expression, r);
      expect_close(jet.d, (8 * (f(1) - f(-1)) - (f(2) - f(-2))) / (12 * h), 1e-8, text);
      expect_close(jet.dd, (16 * (f(1) + f(-1)) - (f(2) + f(-2)) - 30 * f(0)) / (12 * h * h), 1e-6, text);
    }
  }
}

TEST(Expression, PowerIsRightAssociativeAndBindsTighterThanMinus) {
  EXPECT_EQ(evaluate(compile("-r^2"), 3), -9);
  EXPECT_EQ(evaluate(compile("2^r^2"), 3), 512);
  EXPECT_EQ(evaluate(compile("2^-r"), 1), 0.5);
  EXPECT_EQ(evaluate(compile("--r"), 2), 2);
  EXPECT_EQ(evaluate(compile("3 - -r"), 2), 5);
  EXPECT_EQ(evaluate(compile("(-r)^2"), 3), 9);
  EXPECT_EQ(evaluate(compile("(-r)^3"), 2), -8);
  EXPECT_EQ(evaluate(compile("8-r-1"), 2), 5);
  EXPECT_EQ(evaluate(compile("8/r/2"), 2), 2);
}

TEST(Expression, AProductNeedsNoSignWhereAFactorFollows) {
  EXPECT_EQ(evaluate(compile("2.5r^2"), 2), 10);
  EXPECT_EQ(evaluate(compile("r(r+1)"), 2), 6);
  EXPECT_EQ(evaluate(compile("(r+1)(r-1)sqrt(4r(r))"), 2), 12);
  EXPECT_EQ(evaluate(compile("1/2r"), 2), 1);
  EXPECT_EQ(evaluate(compile("1-2r"), 3), -5);
  EXPECT_EQ(evaluate(compile("r^2(1+r)"), 2), 12);
  EXPECT_EQ(evaluate(compile("2e3r"), 1), 2000);
  EXPECT_DOUBLE_EQ(evaluate(compile("2e"), 1), 2 * 2.718281828459045);
  EXPECT_NE(complaint("2 r"), "");
  EXPECT_NE(complaint("r r"), "");
}

TEST(Expression, ErrorsNameTheColumnAndWhatWasExpected) {
  const auto expect = [](const std::string& text, const std::string& column, const std::string& wanted) {
    const std::string message = complaint(text);
    EXPECT_NE(message.find("--curve: column " + column + ":"), std::string::npos) << text << " -> " << message;
    EXPECT_NE(message.find(wanted), std::string::npos) << text << " -> " << message;
  };
  expect("", "1", "expected a number");
  expect("r+", "3", "the text ends");
  expect("r+*2", "3", "found '*'");
  expect("1-foo(r)", "3", "the name 'foo'");
  expect("sqrt r", "6", "expected '('");
  expect("(1-r", "5", "')'");
  expect("1-r)", "4", "found ')'");
  expect("min(r)", "6", "','");
  expect("1e999", "1", "range of a double");
  expect("1\xe2\x88\x92r", "2", "not plain ASCII");
  expect("r^(1/0)", "8", "finite exponent");
  expect(".", "1", "expected a number");
  EXPECT_EQ(complaint("1 -\tr^2"), "");
}

TEST(Expression, HostileTextIsRefusedOrCompiled) {
  EXPECT_NE(complaint(std::string(5000, '1')).find("4096"), std::string::npos);
  EXPECT_NE(complaint(std::string(4000, '(')).find("deeper"), std::string::npos);
  EXPECT_NE(complaint(std::string(4000, '-') + "r").find("deeper"), std::string::npos);
  std::string tower = "r";
  for (int i = 0; i < 1000; ++i) tower += "^r";
  EXPECT_NE(complaint(tower).find("deeper"), std::string::npos);
  std::string chain = "r";
  while (chain.size() < 4090) chain += "+r";
  EXPECT_EQ(evaluate(compile(chain), 1), static_cast<double>((chain.size() + 1) / 2));
  std::mt19937_64 random(7);
  const std::string alphabet = "rrr0123456789.+-*/^()(),eE \t\"%sqrtlogtanhpimaxabs\xff\n";
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (std::uint64_t n = random() % 24; n > 0; --n) text += alphabet[random() % alphabet.size()];
    if (complaint(text).empty()) enclose_jet(compile(text), {0.1, 0.9});
  }
}

} // namespace
} // namespace domewarp
