// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/analysis.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "domewarp/core/errors.h"

namespace domewarp {
namespace {

double domain_end(const std::string& text, double limit = 5.0 / 3) { return find_domain_end(make_curve(text), limit); }
std::vector<double> folds(const std::string& text, double end) { return find_folds(make_curve(text), end, 0); }
std::vector<double> kinks(const std::string& text, double end) { return find_kinks(make_curve(text), end); }

TEST(Analysis, FindsTheEndOfTheDomain) {
  EXPECT_EQ(domain_end("sqrt(1-r^2)"), 1);
  EXPECT_EQ(domain_end("sqrt(0.25-r^2)"), 0.5);
  EXPECT_NEAR(domain_end("sqrt(0.5-r^2)"), std::sqrt(0.5), 2e-16);
  EXPECT_NEAR(domain_end("2+log(0.7-r)"), 0.7, 3e-16);
  EXPECT_NEAR(domain_end("1/(1.2-r)"), 1.2, 1e-11);
  EXPECT_NEAR(domain_end("2+atan(1/(r-0.4))"), 0.4, 2e-16) << "defined beside the jump on either side";
  EXPECT_NEAR(domain_end("1-tan(r)", 3), std::acos(-1) / 2, 1e-11);
  EXPECT_NEAR(domain_end("2-acos(r)/2"), 1, 0);
  EXPECT_EQ(domain_end("1-r^2"), 5.0 / 3);
  EXPECT_EQ(domain_end("r/tan(r*pi/2)"), 5.0 / 3) << "the pole of the tangent at r = 1 is a zero of the quotient";
  EXPECT_NEAR(domain_end("r/tan(r*pi/2)", 3), 2, 1e-11);
}

TEST(Analysis, FindsFoldsAsPublished) {
  const std::vector<double> four = folds("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1", 5.0 / 3);
  ASSERT_EQ(four.size(), 3u);
  EXPECT_NEAR(four[0], 0.4583, 5e-5);
  EXPECT_NEAR(four[1], 0.7957, 5e-5);
  EXPECT_NEAR(four[2], 1.0692, 5e-5);
  const std::vector<double> tanh_folds = folds("-tanh(r-1)", 3);
  ASSERT_EQ(tanh_folds.size(), 1u);
  EXPECT_NEAR(tanh_folds[0], 2.0622, 5e-5);
  const std::vector<double> log_folds = folds("-log(r+0.1)", 3);
  ASSERT_EQ(log_folds.size(), 1u);
  EXPECT_NEAR(log_folds[0], 2.516, 5e-4);
}

TEST(Analysis, FindsNoFoldOnSingleValuedCurves) {
  for (const char* text : {"1-r^2", "1-r", "3-sqrt(4+6*r^2)", "-r^3+r^2+r+1", "1-2.5*r^2", "2-(r+0.01)^r",
                           "-log(r+0.1)", "r/tan(r*pi/2)", "-tanh(r-1)", "1-abs(r-.37)", "1"})
    EXPECT_TRUE(folds(text, 5.0 / 3).empty()) << text;
  EXPECT_TRUE(folds("sqrt(1-r^2)", 1).empty());
}

TEST(Analysis, AFoldAtACornerIsFound) {
  // h jumps from +1 to -1 at the corner, without a zero.
  const std::vector<double> found = folds("1+max(0,3*(r-0.7))", 1.5);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0], 0.7, 1e-15);
}

TEST(Analysis, ATouchThatDoesNotTurnIsNoFold) {
  // h = 1 - 3r^2 + 2r^3 = (1-r)^2 (1+2r), which touches zero at r = 1.
  EXPECT_TRUE(folds("1+3*r^2-r^3", 1.5).empty());
  EXPECT_EQ(folds("1+3.01*r^2-r^3", 1.5).size(), 2u) << "just beyond, it crosses twice";
}

TEST(Analysis, FindsKinksAndKneesOnly) {
  const std::vector<double> corner = kinks("1-abs(r-.37)", 5.0 / 3);
  ASSERT_EQ(corner.size(), 1u);
  EXPECT_NEAR(corner[0], 0.37, 2e-16);
  const std::vector<double> two = kinks("max(min(1-r,0.8),0.1)", 5.0 / 3);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_NEAR(two[0], 0.2, 2e-15);
  EXPECT_NEAR(two[1], 0.9, 2e-15);
  EXPECT_TRUE(kinks("2-(r+0.01)^r", 5.0 / 3).empty());
  EXPECT_TRUE(kinks("sqrt(1-r^2)", 1).empty()) << "a vertical tangent at the end is not inside";
  EXPECT_TRUE(kinks("1-abs(r)", 1).empty());
}

TEST(Analysis, IrregularCurvesAreRefusedInsteadOfTakingForEver) {
  for (const char* text : {"2+sin(1e6*r)", "2+abs(sin(1e6*r))", "max(0.5,r)"})
    EXPECT_THROW(
        {
          const Curve curve = make_curve(std::string(text));
          find_kinks(curve, 1);
          find_folds(curve, 1, 0);
        },
        Error)
        << text;
}

} // namespace
} // namespace domewarp
