// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/refine/visible_region.h"

namespace domewarp {
namespace {

constexpr double degree = std::numbers::pi / 180;

Branch branch_to(double theta_high) {
  Branch branch;
  branch.theta_high = theta_high;
  return branch;
}

TEST(VisibleRegion, SidesFollowTheAngleBelowAndAboveNinetyDegrees) {
  for (const double limit : {30.0, 90.0, 125.0, 164.0}) {
    const VisibleRegion region = make_visible_region(branch_to(limit * degree), 1e-6);
    for (double theta = 1; theta < 180; theta += 1) {
      const Vec3 p = 7.0 * Vec3(std::sin(theta * degree) * 0.6, std::sin(theta * degree) * 0.8, -std::cos(theta * degree));
      const int expected = std::abs(theta - limit) < 1e-9 ? 0 : theta < limit ? 1 : -1;
      EXPECT_EQ(sides_of(region, p)[0], expected) << theta << " of " << limit;
    }
  }
}

TEST(VisibleRegion, CrossingsLieOnTheBoundary) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-5, 5);
  int crossings = 0;
  for (int i = 0; i < 20000; ++i) {
    const VisibleRegion region = make_visible_region(branch_to((10 + 160.0 * i / 20000) * degree), 1.5);
    const Vec3 a(coordinate(random), coordinate(random), coordinate(random)), b(coordinate(random), coordinate(random), coordinate(random));
    for (std::size_t k = 0; k < region.boundaries.size(); ++k) {
      if (sides_of(region, a)[k] * sides_of(region, b)[k] >= 0) continue;
      const double t = crossing(region.boundaries[k], a, b);
      EXPECT_LT(std::abs(signed_distance(region.boundaries[k], point_at(a, b, t))), 1e-13);
      ++crossings;
    }
  }
  EXPECT_GT(crossings, 5000);
}

TEST(VisibleRegion, TheExtremumIsTheExtremum) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> coordinate(-5, 5);
  const VisibleRegion region = make_visible_region(branch_to(1), 1);
  const auto theta = [](const Vec3& p) { return std::atan2(std::hypot(p.x, p.y), -p.z); };
  for (int i = 0; i < 2000; ++i) {
    const Vec3 a(coordinate(random), coordinate(random), coordinate(random)), b(coordinate(random), coordinate(random), coordinate(random));
    double low = std::min(theta(a), theta(b)), high = std::max(theta(a), theta(b));
    if (const auto t = extremum(region.boundaries[0], a, b)) {
      low = std::min(low, theta(point_at(a, b, *t)));
      high = std::max(high, theta(point_at(a, b, *t)));
    }
    for (int s = 1; s < 50; ++s) {
      const double sampled = theta(point_at(a, b, s / 50.0));
      EXPECT_GE(sampled, low - 1e-12);
      EXPECT_LE(sampled, high + 1e-12);
    }
  }
}

} // namespace
} // namespace domewarp
