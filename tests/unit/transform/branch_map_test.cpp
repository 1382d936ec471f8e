// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "domewarp/transform/continuation.h"
#include "domewarp/transform/image_map.h"
#include "surfaces.h"

namespace domewarp {
namespace {

constexpr double pi = std::numbers::pi;

struct Difference {
  double radius = 0, weight = 0;
};

// Next to a fold and on a wall that the ray grazes, a rounding of the direction moves both methods by more than the
// promise: R's own error there is what an ulp of theta moves it by.
Difference compare(const Surface& surface, std::size_t branch, int count) {
  const BranchMap table(surface, branch, Method::table), direct(surface, branch, Method::direct);
  std::mt19937_64 random(42 + branch);
  std::uniform_real_distribution<double> uniform(0, 1);
  Difference worst;
  for (const double theta : branch_angles(surface.branches()[branch], random, count)) {
    const Vec3 p = towards(theta, 7 * uniform(random));
    const Vec2 a = table.image(p), b = direct.image(p);
    const double own = 2e-16 * std::min(std::abs(surface.radial(branch, theta).dr), 1e8);
    worst.radius = std::max(worst.radius, std::hypot(a.x - b.x, a.y - b.y) - own);
    worst.weight = std::max(worst.weight, std::abs(table.factors(p).g / direct.factors(p).g - 1));
  }
  return worst;
}

TEST(BranchMap, TheTableAgreesWithTheDirectMethod) {
  for (const Surface& surface : many_surfaces())
    for (std::size_t i = 0; i < surface.branches().size(); ++i) {
      const Difference difference = compare(surface, i, 1000);
      EXPECT_LT(difference.radius, 1e-10) << describe(surface) << " branch " << i;
    }
}

TEST(BranchMap, TheWeightIsTheSameEitherWayButAtKinks) {
  for (const Surface& surface : many_surfaces())
    for (std::size_t i = 0; i < surface.branches().size(); ++i) {
      EXPECT_LT(compare(surface, i, 300).weight, 1e-6) << describe(surface) << " branch " << i;
    }
}

TEST(BranchMap, EveryThesisCurveGetsATable) {
  for (const ReferenceCurve& curve : reference_curves()) {
    const Surface surface = curve_surface(curve.text);
    for (std::size_t i = 0; i < surface.branches().size(); ++i) {
      const BranchMap map(surface, i, Method::automatic);
      EXPECT_TRUE(map.table().used) << curve.text << " branch " << i;
      EXPECT_LE(map.table().max_error, 1e-10) << curve.text;
      EXPECT_GT(map.table().pieces, 0);
    }
  }
}

TEST(BranchMap, AutomaticUsesATableWhereManyPointsComeAndSaysWhyNot) {
  const Surface surface = curve_surface("1-r^2");
  const auto report = [&](Method method, std::size_t points) { return BranchMap(surface, 0, method, points).table(); };
  EXPECT_FALSE(report(Method::automatic, table_pays_from - 1).used);
  EXPECT_EQ(report(Method::automatic, table_pays_from - 1).reason, TableReason::few_points);
  EXPECT_TRUE(report(Method::automatic, table_pays_from).used);
  EXPECT_EQ(report(Method::automatic, table_pays_from).reason, TableReason::used);
  EXPECT_TRUE(report(Method::table, 1).used);
  EXPECT_FALSE(report(Method::direct, many_points).used);
  EXPECT_EQ(report(Method::direct, 1).reason, TableReason::direct_asked);
}

// Halving goes on only where it has to: near-grazing rims and folds were tabulated in 128 and 4120 even pieces.
TEST(BranchMap, TablesAreSmall) {
  for (const Surface& surface : many_surfaces())
    for (std::size_t i = 0; i < surface.branches().size(); ++i) {
      const BranchMap map(surface, i, Method::table);
      const TableReport& table = map.table();
      const bool closes_behind = map.branch().theta_high >= pi && map.branch().radius_high == 0;
      EXPECT_EQ(table.used, !closes_behind) << describe(surface);
      EXPECT_LE(table.pieces, 64) << describe(surface) << " branch " << i;
    }
}

TEST(BranchMap, ATableThatMissesThePromiseIsNotUsedAndSaysSo) {
  const Surface surface = lens_surface(Lens::stereographic, 359, 1.0);
  const BranchMap map(surface, 0, Method::table);
  EXPECT_FALSE(map.table().used);
  EXPECT_EQ(map.table().reason, TableReason::inexact);
  EXPECT_GT(map.table().max_error, 1e-10);
  const Vec3 p = towards(3, 1);
  EXPECT_EQ(map.factors(p).k, BranchMap(surface, 0, Method::direct).factors(p).k);
}

TEST(BranchMap, ImageIsTheFactorTimesTheDirection) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (const Surface& surface : many_surfaces())
    for (std::size_t i = 0; i < surface.branches().size(); ++i)
      for (const Method method : {Method::direct, Method::table}) {
        const BranchMap map(surface, i, method);
        for (int k = 0; k < 50; ++k) {
          const Vec3 p(normal(random), normal(random), normal(random));
          const double scale = map.factors(p).k / glm::length(p);
          const Vec2 image = map.image(p);
          EXPECT_NEAR(image.x, p.x * scale, 1e-14 * (1 + std::abs(p.x * scale)));
          EXPECT_NEAR(image.y, p.y * scale, 1e-14 * (1 + std::abs(p.y * scale)));
        }
      }
}

TEST(BranchMap, DependsOnTheDirectionOnlyAtAnyDistance) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  for (const char* text : {"1-r^2", "-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1", "sqrt(1-r^2)"}) {
    const Surface surface = curve_surface(text);
    for (const Method method : {Method::direct, Method::table}) {
      const BranchMap map(surface, 0, method);
      for (int i = 0; i < 200; ++i) {
        const Vec3 p(normal(random), normal(random), normal(random));
        for (const int exponent : {-1000, -700, -300, 1, 300, 700, 1000}) {
          const Vec3 q(std::ldexp(p.x, exponent), std::ldexp(p.y, exponent), std::ldexp(p.z, exponent));
          EXPECT_EQ(map.factors(q).k, map.factors(p).k) << exponent;
          EXPECT_EQ(map.factors(q).g, map.factors(p).g) << exponent;
          EXPECT_EQ(map.image(q), map.image(p)) << exponent;
          EXPECT_EQ(map.inside(q).x, std::ldexp(map.inside(p).x, exponent)) << exponent;
        }
      }
    }
  }
}

TEST(BranchMap, IsRegularOnTheAxis) {
  for (const Surface& surface : many_surfaces()) {
    if (surface.branches()[0].theta_low > 0) continue;
    const double expected = surface.radial(0, 0).dr;
    for (const Method method : {Method::direct, Method::table}) {
      const BranchMap map(surface, 0, method);
      for (const double x : {0.0, -0.0, 5e-324, 1e-310, 1e-200, 1e-155, 1e-40, 1e-16}) {
        EXPECT_NEAR(map.factors({x, 0, -1}).k, expected, 1e-12 * expected) << describe(surface) << " " << x;
        EXPECT_NEAR(map.image({x, 0, -1}).x, x * expected, 1e-12 * x + 5e-324);
        EXPECT_EQ(map.image({x, 0, -1}).y, 0);
      }
    }
  }
}

TEST(BranchMap, TheBackwardAxisIsACircleAndNeverTheCentre) {
  const Surface surface = lens_surface(Lens::equidistant, 360);
  for (const Method method : {Method::direct, Method::table}) {
    const BranchMap map(surface, 0, method);
    for (const double x : {5e-324, 1e-310, 1e-200, 1e-155, 1e-40, 1e-16}) {
      const Vec2 image = map.image({x, -x, 1});
      EXPECT_NEAR(image.x, std::sqrt(0.5), 1e-12);
      EXPECT_NEAR(image.y, -std::sqrt(0.5), 1e-12);
      EXPECT_TRUE(std::isfinite(map.factors({x, -x, 1}).k));
    }
    EXPECT_EQ(map.image({0, 0, 1}), Vec2(1, 0));
    EXPECT_EQ(map.inside({0, 0, 1}).y, 1);
  }
}

TEST(BranchMap, InsideTellsOnWhichSideOfEachEnd) {
  const Surface surface = curve_surface("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1");
  for (std::size_t i = 0; i < surface.branches().size(); ++i) {
    const BranchMap map(surface, i, Method::direct);
    const auto [low, high] = std::pair(map.branch().theta_low, map.branch().theta_high);
    for (double theta = 0.001; theta < pi; theta += 0.0037) {
      const Vec2 side = map.inside(2.0 * towards(theta, 1));
      EXPECT_NEAR(side.x, low == 0 ? 2 : 2 * std::sin(theta - low), 1e-14);
      EXPECT_NEAR(side.y, 2 * std::sin(high - theta), 1e-14);
    }
  }
}

TEST(BranchMap, GoesOnBeyondItsEnds) {
  for (const Surface& surface : {curve_surface("1-r^2"), curve_surface("-tanh(r-1)", std::nullopt, 3)})
    for (std::size_t i = 0; i < surface.branches().size(); ++i)
      for (const Method method : {Method::direct, Method::table}) {
        const BranchMap map(surface, i, method);
        const double end = map.branch().theta_high;
        const Continuation after(surface, i, true);
        for (const double beyond : {0.0, 1e-9, 1e-3, 0.1}) {
          const double theta = end + beyond, radius = map.factors(towards(theta, 2)).k * std::sin(theta);
          EXPECT_NEAR(radius, after.radius(std::sin(theta), std::cos(theta)), map.branch().fold_high ? 1e-7 : 1e-12);
        }
        const double g = map.factors(towards(3.1, 1)).g;
        EXPECT_TRUE(std::isfinite(g) && g > 0);
      }
}

TEST(BranchMap, OutlivesTheSurfaceItWasMadeFrom) {
  std::optional<BranchMap> map;
  {
    const Surface surface = curve_surface("1-r^2");
    map.emplace(surface, 0, Method::direct);
  }
  EXPECT_NEAR(map->image(towards(pi / 2, 0)).x, 1, 1e-15);
}

} // namespace
} // namespace domewarp
