// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/interval.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "domewarp/profile/curve.h"
#include "reference_curves.h"

namespace domewarp {
namespace {

bool holds(const Interval& interval, const Real& value) {
  return value.is_nan() || (value.compare(interval.lo) >= 0 && value.compare(interval.hi) <= 0);
}

struct Cell {
  Interval interval;
  double point;
};

// Cells of all widths, with a point that is often an end.
Cell random_cell(std::mt19937_64& random, double low, double high) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const double width = std::pow(10, -16 * uniform(random)) * (high - low);
  const double a = low + (high - low - width) * uniform(random), b = std::min(a + width, high);
  const double part = std::clamp(1.2 * uniform(random) - 0.1, 0.0, 1.0);
  return {{a, b}, std::clamp(a + (b - a) * part, a, b)};
}

struct Function {
  const char* name;
  Interval (*interval)(const Interval&);
  Real (*real)(const Real&);
  double low, high;
};

const Function functions[] = {
    {"sqrt", sqrt, sqrt, -1, 4},     {"exp", exp, exp, -800, 750},  {"log", log, log, -1, 10},
    {"log10", log10, log10, -1, 9},  {"sin", sin, sin, -50, 50},    {"cos", cos, cos, -50, 50},
    {"tan", tan, tan, -7, 7},        {"cot", cot, cot, -7, 7},      {"asin", asin, asin, -1.2, 1.2},
    {"acos", acos, acos, -1.2, 1.2}, {"atan", atan, atan, -9, 9},   {"sinh", sinh, sinh, -9, 9},
    {"cosh", cosh, cosh, -9, 9},     {"tanh", tanh, tanh, -30, 30}, {"abs", abs, abs, -2, 3},
};

TEST(Interval, EncloseElementaryFunctions) {
  std::mt19937_64 random(11);
  for (const Function& function : functions)
    for (int i = 0; i < 4000; ++i) {
      const Cell cell = random_cell(random, function.low, function.high);
      const Interval result = function.interval(cell.interval);
      ASSERT_TRUE(holds(result, function.real(cell.point)))
          << function.name << " of [" << cell.interval.lo << ", " << cell.interval.hi << "] at " << cell.point;
    }
}

TEST(Interval, EncloseLargeAnglesAndExtrema) {
  std::mt19937_64 random(12);
  for (int i = 0; i < 4000; ++i) {
    const Cell far = random_cell(random, -2e6, 2e6);
    ASSERT_TRUE(holds(sin(far.interval), sin(Real(far.point))));
    ASSERT_TRUE(holds(cos(far.interval), cos(Real(far.point))));
    const double top = (static_cast<int>(random() % 20) - 10) * 1.5707963267948966;
    const Cell near = random_cell(random, top - 1e-7, top + 1e-7);
    ASSERT_TRUE(holds(sin(near.interval), sin(Real(near.point))));
    ASSERT_TRUE(holds(tan(near.interval), tan(Real(near.point))));
    ASSERT_TRUE(holds(cot(near.interval), cot(Real(near.point))));
  }
}

TEST(Interval, EncloseArithmeticAndPowers) {
  std::mt19937_64 random(13);
  for (int i = 0; i < 20000; ++i) {
    const Cell a = random_cell(random, -3, 3), b = random_cell(random, -3, 3), positive = random_cell(random, 0, 3);
    const Real x(a.point), y(b.point), p(positive.point);
    ASSERT_TRUE(holds(a.interval + b.interval, x + y));
    ASSERT_TRUE(holds(a.interval - b.interval, x - y));
    ASSERT_TRUE(holds(a.interval * b.interval, x * y));
    if (b.point != 0) {
      ASSERT_TRUE(holds(a.interval / b.interval, x / y));
    }
    ASSERT_TRUE(holds(max(a.interval, b.interval), x < y ? y : x));
    ASSERT_TRUE(holds(min(a.interval, b.interval), x < y ? x : y));
    for (const int n : {-3, -2, 0, 1, 2, 3, 7}) {
      if (n < 0 && a.point == 0) continue;
      ASSERT_TRUE(holds(power(a.interval, n), pow(x, Real(n)))) << n;
    }
    for (const double n : {0.5, 2.5, -1.5}) {
      if (n < 0 && positive.point == 0) continue;
      ASSERT_TRUE(holds(power(positive.interval, n), pow(p, Real(n)))) << n;
    }
    if (positive.point > 0) {
      ASSERT_TRUE(holds(power(positive.interval, b.interval), pow(p, y)));
    }
  }
}

// Whether it holds the number that a rough one stands for; false where the rough one is too near an end to tell.
bool holds(const Interval& interval, const Rough& value) {
  return value.value() - value.error() >= interval.lo && value.value() + value.error() <= interval.hi;
}

TEST(Interval, EncloseAHundredThousandValuesOfEachThesisCurve) {
  std::mt19937_64 random(15);
  for (const ReferenceCurve& reference : reference_curves()) {
    const Curve curve = make_curve(std::string(reference.text));
    for (int i = 0; i < 100000; ++i) {
      const Cell cell = random_cell(random, 0, reference.end);
      const Interval f = enclose_jet(curve, cell.interval).v;
      const bool is_held = holds(f, reference.at(Rough(cell.point))) || holds(f, reference.at(Real(cell.point)));
      ASSERT_TRUE(is_held) << reference.text << " at " << cell.point;
    }
  }
}

TEST(Interval, TheRoughNumbersOfTheTestsHoldTheExactOnes) {
  std::mt19937_64 random(16);
  for (const ReferenceCurve& reference : reference_curves()) {
    int sharp = 0;
    for (int i = 0; i < 2000; ++i) {
      const double r = random_cell(random, 0, reference.end).point;
      const Rough value = reference.at(Rough(r));
      ASSERT_TRUE(value.contains(reference.at(Real(r)))) << reference.text << " at " << r;
      sharp += !(value + Rough(1e-17)).contains(reference.at(Real(r)));
    }
    EXPECT_GT(sharp, 1500) << reference.text;
  }
}

TEST(Interval, EncloseTheThesisCurvesWithTheirDerivatives) {
  std::mt19937_64 random(14);
  const Real step("1e-20"), wide("1e-15");
  for (const ReferenceCurve& reference : reference_curves()) {
    const Curve curve = make_curve(std::string(reference.text));
    for (int i = 0; i < 10000; ++i) {
      const Cell cell = random_cell(random, 0, reference.end);
      const Jet<Interval> jet = enclose_jet(curve, cell.interval);
      ASSERT_TRUE(holds(jet.v, reference.value(cell.point))) << reference.text << " at " << cell.point;
      const Real slope =
          (reference.value(Real(cell.point) + step) - reference.value(Real(cell.point) - step)) / (step + step);
      // Differences stand for the derivative to 1e-20 except at an end of the domain.
      if (cell.point < 1e-9 || cell.point > reference.end - 1e-9) continue;
      const Interval slack(std::nextafter(jet.d.lo, -1e300), std::nextafter(jet.d.hi, 1e300));
      ASSERT_TRUE(holds(slack, slope)) << reference.text << " at " << cell.point;
      const Real x(cell.point), second = (reference.value(x + wide) - Real(2) * reference.value(x) + reference.value(x - wide)) / (wide * wide);
      // At a kink there is no second derivative, and differences cross it.
      if (std::abs(cell.point - reference.kink) < 1e-9) continue;
      const double room = 1e-12 * (1 + std::max(std::abs(jet.dd.lo), std::abs(jet.dd.hi)));
      ASSERT_TRUE(holds(Interval(jet.dd.lo - room, jet.dd.hi + room), second)) << reference.text << " at " << cell.point;
    }
  }
}

TEST(Interval, AreSharpOnSmallCells) {
  const Curve curve = make_curve(std::string("2-(r+0.01)^r"));
  const Jet<Interval> jet = enclose_jet(curve, {0.5, 0.5 + 1e-6});
  EXPECT_LT(jet.v.hi - jet.v.lo, 1e-5);
  EXPECT_LT(jet.dd.hi - jet.dd.lo, 1e-4);
}

TEST(Interval, TheCheckNoticesAnIntervalThatIsTooNarrow) {
  const Interval narrow(std::nextafter(1 / 3.0, 1), 1);
  EXPECT_FALSE(holds(narrow, Real(1) / Real(3)));
  EXPECT_TRUE(holds(Interval(1) / Interval(3), Real(1) / Real(3)));
}

TEST(Interval, KnowWhereAFunctionIsUndefinedOrNotSmooth) {
  EXPECT_EQ(sqrt(Interval(-1, 1)).regularity, Regularity::unknown);
  EXPECT_EQ(sqrt(Interval(0, 1)).regularity, Regularity::continuous);
  EXPECT_EQ(sqrt(Interval(0.1, 1)).regularity, Regularity::smooth);
  EXPECT_EQ(abs(Interval(-1, 1)).regularity, Regularity::continuous);
  EXPECT_EQ(tan(Interval(1, 2)).regularity, Regularity::unknown);
  EXPECT_EQ(tan(Interval(2, 3)).regularity, Regularity::smooth);
  EXPECT_EQ((Interval(1) / Interval(-1, 1)).regularity, Regularity::unknown);
  EXPECT_EQ((Interval(1) / Interval(0, 1)).regularity, Regularity::unknown);
  EXPECT_EQ(log(Interval(0, 1)).regularity, Regularity::unknown);
  EXPECT_EQ(max(Interval(0, 1), Interval(0.5, 2)).regularity, Regularity::continuous);
  EXPECT_EQ(max(Interval(0, 1), Interval(3, 4)).regularity, Regularity::smooth);
  EXPECT_EQ(exp(sqrt(Interval(-1, 1))).regularity, Regularity::unknown);
}

} // namespace
} // namespace domewarp
