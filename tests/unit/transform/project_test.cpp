// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/transform/image_map.h"
#include "random_expression.h"
#include "surfaces.h"

namespace domewarp {
namespace {

constexpr double pi = std::numbers::pi;

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

TEST(Project, AndBackGivesTheDirection) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const Surface& surface : many_surfaces())
    for (const Method method : {Method::direct, Method::table}) {
      const ImageMap map = make_image_map(surface, method);
      for (const BranchMap& branch : map.branches)
        for (const double theta : branch_angles(branch.branch(), random, 300)) {
          const Vec3 direction = towards(theta, 7 * uniform(random));
          const ImagePoint point = project(surface, map, direction * std::exp2(60 * uniform(random) - 30));
          if (point.state != PointState::visible) continue; // an end, rounded outwards
          Vec3 back;
          ASSERT_TRUE(unproject(surface, {point.x, point.y}, back)) << describe(surface) << " " << theta;
          EXPECT_NEAR(glm::length(back), 1, 1e-15);
          // Where the picture hardly moves with the view angle its error weighs more, to its root at a vertical
          // tangent.
          const RadialJet jet = surface.radial(surface.branch_at(std::hypot(point.x, point.y)), theta);
          const double error = 6e-16 * surface.r_max() + (method == Method::table ? 2e-13 : 0);
          const double room = 1e-12 + std::min(error / std::abs(jet.dr), 2 * std::sqrt(error / std::abs(jet.d2r)));
          EXPECT_LT(angle_between(back, direction), room) << describe(surface) << " " << theta;
        }
    }
}

TEST(Project, BackAndForthGivesThePoint) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const Surface& surface : many_surfaces()) {
    if (surface.branches().size() > 1) continue; // other branches hide all but the nearest
    const ImageMap map = make_image_map(surface, Method::automatic);
    for (int i = 0; i < 300; ++i) {
      const double radius = 0.999 * surface.r_max() * uniform(random), phi = 7 * uniform(random);
      const Vec2 image(radius * std::cos(phi), radius * std::sin(phi));
      Vec3 direction;
      ASSERT_TRUE(unproject(surface, image, direction));
      const ImagePoint point = project(surface, map, direction);
      EXPECT_EQ(point.state, PointState::visible);
      EXPECT_NEAR(point.x, image.x, 1e-10) << describe(surface);
      EXPECT_NEAR(point.y, image.y, 1e-10) << describe(surface);
    }
  }
}

TEST(Project, NothingIsSeenBeyondRMax) {
  for (const Surface& surface : many_surfaces()) {
    Vec3 direction;
    EXPECT_TRUE(unproject(surface, {surface.r_max(), 0}, direction));
    EXPECT_TRUE(unproject(surface, {0, 0}, direction));
    EXPECT_FALSE(unproject(surface, {surface.r_max() * (1 + 1e-12), 0}, direction));
    EXPECT_FALSE(unproject(surface, {std::nan(""), 0}, direction));
    EXPECT_FALSE(unproject(surface, {HUGE_VAL, 0}, direction));
  }
}

TEST(Project, StatesAreThoseOfTheAngle) {
  const Surface surface = curve_surface("1-r^2");
  const ImageMap map = make_image_map(surface, Method::automatic);
  const double end = surface.branches()[0].theta_high, blind = surface.blind().theta_low;
  for (double theta = 0; theta <= pi; theta += 0.003) {
    const ImagePoint point = project(surface, map, 3.0 * towards(theta, 1));
    EXPECT_EQ(point.state, theta < end     ? PointState::visible
                           : theta < blind ? PointState::extended
                                           : PointState::blind);
    EXPECT_NEAR(point.depth, 3, 1e-15 * 3);
    const double radius = std::hypot(point.x, point.y);
    if (point.state == PointState::visible) {
      EXPECT_LE(radius, surface.r_max() * (1 + 2e-15));
    } else if (point.state == PointState::extended) {
      EXPECT_GE(radius, surface.r_max() * (1 - 1e-15));
    } else {
      EXPECT_TRUE(std::isnan(point.x) && std::isnan(point.y));
    }
  }
}

TEST(Project, TheNearestBranchWins) {
  const Surface surface = curve_surface("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1");
  const ImageMap map = make_image_map(surface, Method::automatic);
  // 18 degrees lies in branches 0 and 1 only, 17.5 in all four.
  for (const double theta_deg : {5.0, 17.5, 18.0, 19.0}) {
    const ImagePoint point = project(surface, map, towards(theta_deg * pi / 180, 0));
    EXPECT_EQ(point.state, PointState::visible);
    EXPECT_LT(point.x, 0.4584);
  }
  EXPECT_NE(project(surface, map, towards(0.5, 0)).state, PointState::visible);
}

TEST(Project, ADirectionOnlyTheLaterBranchHoldsIsFoundThere) {
  const Surface surface = curve_surface("-1+r^2");
  const ImageMap map = make_image_map(surface, Method::automatic);
  EXPECT_EQ(project(surface, map, {0, 0, 1}).state, PointState::visible);
  EXPECT_EQ(project(surface, map, {0, 0, 1}).x, 0);
  EXPECT_NE(project(surface, map, {0, 0, -1}).state, PointState::visible);
}

// What holds whatever the surface: states agree, images are finite and within r_max, every image radius has a ray.
void expect_sane(const Surface& surface, std::mt19937_64& random) {
  const ImageMap map = make_image_map(surface, Method::automatic), direct = make_image_map(surface, Method::direct);
  for (int k = 0; k < 40; ++k) {
    const Vec3 p = towards(pi * k / 39, static_cast<double>(random() % 7));
    const ImagePoint point = project(surface, map, p), expected = project(surface, direct, p);
    EXPECT_EQ(point.state, expected.state) << describe(surface);
    if (point.state != PointState::blind) {
      EXPECT_TRUE(std::isfinite(point.x + point.y)) << describe(surface);
    }
    if (point.state == PointState::visible) {
      EXPECT_LE(std::hypot(point.x, point.y), surface.r_max() * (1 + 2e-15)) << describe(surface);
    }
    for (const BranchMap& branch : map.branches) {
      const RadialFactors factors = branch.factors(p);
      const Vec3 jet = branch.weight_jet(pi * k / 39);
      EXPECT_TRUE(std::isfinite(factors.k) && factors.g > 0 && std::isfinite(jet.x + jet.y + jet.z))
          << describe(surface);
    }
    Vec3 direction;
    EXPECT_TRUE(unproject(surface, {surface.r_max() * k / 39, 0}, direction)) << describe(surface);
    EXPECT_NEAR(glm::length(direction), 1, 1e-14) << describe(surface);
  }
}

TEST(Project, HoldsOnRandomCurvesOrTheyAreRefused) {
  std::mt19937_64 random(77);
  int accepted = 0;
  for (int i = 0; i < 150; ++i) {
    SurfaceOptions options;
    options.curve = random_text(random, 1 + static_cast<int>(random() % 4));
    if (random() % 3 == 0) options.projector = std::exp2(static_cast<double>(random() % 40) - 20);
    if (random() % 5 == 0) options.rmax = std::exp2(static_cast<double>(random() % 40) - 20);
    if (random() % 4 == 0) options.branches = BranchChoice::first;
    try {
      expect_sane(Surface(options, corner_radius), random);
      ++accepted;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
    }
  }
  EXPECT_GT(accepted, 50);
}

TEST(Project, HoldsOnRandomProfiles) {
  std::mt19937_64 random(78);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 20; ++i) {
    SurfaceOptions options;
    options.profile_name = "rows";
    options.profile.emplace_back(0, 1);
    const double rough = std::pow(10, -6 * uniform(random));
    for (std::uint64_t n = 1 + random() % 40; n > 0; --n) {
      const Vec2 last = options.profile.back();
      options.profile.emplace_back(last.x + std::pow(10, -6 * uniform(random)),
                                   last.y + rough * (uniform(random) - 0.5));
    }
    expect_sane(Surface(options, corner_radius), random);
  }
}

// Two thirds of a million points, hostile ones among them.
TEST(Project, NoFinitePointWithAnImageIsLost) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double special[] = {0.0,
                            -0.0,
                            5e-324,
                            1e-310,
                            1e-300,
                            1e-160,
                            1e-40,
                            1e-16,
                            1,
                            -1,
                            1e16,
                            1e38,
                            1e160,
                            1e300,
                            1.7e308,
                            -1e-310,
                            -1e-300,
                            -1e300,
                            std::numeric_limits<double>::infinity(),
                            std::nan("")};
  const auto coordinate = [&]() {
    if (random() % 4 == 0) return special[random() % std::size(special)];
    return (uniform(random) - 0.5) * std::pow(10, 80 * (uniform(random) - 0.5));
  };
  for (const Surface& surface : many_surfaces()) {
    const ImageMap map = make_image_map(surface, Method::automatic);
    const double centre = 1e-9 * surface.r_max();
    for (int i = 0; i < 15000; ++i) {
      const Vec3 p(coordinate(), coordinate(), coordinate());
      const ImagePoint point = project(surface, map, p);
      const bool usable = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && p != Vec3(0);
      if (!usable) {
        ASSERT_EQ(point.state, PointState::blind);
        continue;
      }
      if (point.state == PointState::blind) continue;
      ASSERT_TRUE(std::isfinite(point.x) && std::isfinite(point.y))
          << describe(surface) << " " << p.x << " " << p.y << " " << p.z;
      const double radius = std::hypot(point.x, point.y);
      if (point.state == PointState::visible) {
        ASSERT_LE(radius, surface.r_max() * (1 + 2e-15));
      }
      // The centre of the picture is seen along the axis only.
      const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      const double sine = std::hypot(p.x / largest, p.y / largest);
      if (radius < centre) {
        ASSERT_LT(sine, 1e-6) << describe(surface);
      }
    }
  }
}

} // namespace
} // namespace domewarp
