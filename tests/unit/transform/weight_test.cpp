// SPDX-License-Identifier: Apache-2.0
#include "domewarp/transform/weight.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "domewarp/transform/image_map.h"
#include "surfaces.h"

namespace domewarp {
namespace {

TEST(Weight, IsOneWhereTheSlopeIsTheMean) {
  EXPECT_DOUBLE_EQ(weight(2, 2), 1);
  EXPECT_DOUBLE_EQ(weight(-2, 2), 1);
  const Surface surface = lens_surface(Lens::equidistant, 220);
  const BranchMap map(surface, 0, Method::table);
  for (double theta = 0; theta < 1.9; theta += 0.1) EXPECT_NEAR(map.factors(towards(theta, 1)).g, 1, 1e-13);
}

TEST(Weight, StaysWithinItsBoundsForAnySlope) {
  const double bound = 1 / std::sqrt(BranchMap::weight_epsilon);
  for (const double slope : {0.0, 1e-300, 1e-9, 0.3, 1.0, 7.0, 1e9, 1e300, std::numeric_limits<double>::max()}) {
    EXPECT_LE(weight(slope, 1), bound * (1 + 1e-15));
    EXPECT_GE(weight(slope, 1), (1 - 1e-15) / bound);
    EXPECT_GE(weight(slope, 1), weight(2 * slope, 1));
  }
  EXPECT_DOUBLE_EQ(weight(0, 1), bound);
}

TEST(Weight, IsTheInverseRootOfTheSlopeBetweenTheBounds) {
  for (const double slope : {0.5, 1.0, 2.0}) EXPECT_NEAR(weight(slope, 1), 1 / std::sqrt(slope), 5e-3);
}

TEST(Weight, JetAgreesWithDifferencesOfTheFactors) {
  for (const char* text :
       {"1-r^2", "1", "2-(r+0.01)^r", "sqrt(1-r^2)", "-log(r+0.1)", "-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1"}) {
    const Surface surface = curve_surface(text);
    for (std::size_t i = 0; i < surface.branches().size(); ++i) {
      const BranchMap map(surface, i, Method::direct);
      const Branch& branch = map.branch();
      const double width = branch.theta_high - branch.theta_low, h = 1e-3 * width;
      for (int k = 1; k < 40; ++k) {
        const double theta = branch.theta_low + width * k / 40;
        const auto g = [&](int j) { return map.factors(towards(theta + j * h, 0)).g; };
        const Vec3 jet = map.weight_jet(theta);
        const double first = (8 * (g(1) - g(-1)) - (g(2) - g(-2))) / (12 * h);
        const double second = (16 * (g(1) + g(-1)) - (g(2) + g(-2)) - 30 * g(0)) / (12 * h * h);
        EXPECT_NEAR(jet.x, g(0), 1e-9) << text;
        EXPECT_NEAR(jet.y * width, first * width, 1e-4 * (1 + std::abs(first * width))) << text << " " << theta;
        EXPECT_NEAR(jet.z * width * width, second * width * width, 1e-3 * (10 + std::abs(second * width * width)))
            << text << " " << theta;
      }
    }
  }
}

TEST(Weight, JetIsFiniteUpToTheEnds) {
  for (const Surface& surface : many_surfaces())
    for (std::size_t i = 0; i < surface.branches().size(); ++i) {
      const BranchMap map(surface, i, Method::direct);
      for (const double theta : {map.branch().theta_low, map.branch().theta_high}) {
        const Vec3 jet = map.weight_jet(theta);
        EXPECT_TRUE(std::isfinite(jet.x) && std::isfinite(jet.y) && std::isfinite(jet.z)) << describe(surface);
        EXPECT_NEAR(jet.x, map.factors(towards(theta, 1)).g, 2e-3 * jet.x) << describe(surface) << " " << theta;
      }
    }
}

} // namespace
} // namespace domewarp
