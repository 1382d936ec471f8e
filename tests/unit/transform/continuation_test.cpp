// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "domewarp/transform/continuation.h"
#include "domewarp/transform/image_map.h"
#include "surfaces.h"

namespace domewarp {
namespace {

constexpr double pi = std::numbers::pi;

SurfaceOptions options_of(const std::string& curve, std::optional<double> rmax, std::optional<double> projector = std::nullopt) {
  SurfaceOptions options;
  options.curve = curve;
  options.rmax = rmax;
  options.projector = projector;
  return options;
}

std::vector<SurfaceOptions> options_with_rims() {
  SurfaceOptions lens;
  lens.lens = Lens::equidistant;
  lens.rmax = 0.8;
  return {options_of("1-r^2", 0.9), options_of("1-r^2", 0.9, 1.0), options_of("3-sqrt(4+6*r^2)", 1.2), options_of("-0.5-r^2/4", 0.7), lens};
}

TEST(Continuation, FollowsTheTangentExtensionOfTheSurface) {
  for (const SurfaceOptions& options : options_with_rims()) {
    const Surface surface(options, std::numbers::sqrt2);
    const std::size_t last = surface.branches().size() - 1;
    const Branch& branch = surface.branches()[last];
    const bool rises = branch.orientation > 0;
    const Continuation beyond(surface, last, rises);
    ASSERT_TRUE(beyond.is_tangent()) << options.curve;
    const double end = rises ? branch.theta_high : branch.theta_low;
    for (const double angle : {1e-9, 1e-4, 0.02, 0.1}) {
      const double theta = rises ? end + angle : end - angle;
      const std::optional<double> expected = surface.extended_radius(Vec3(std::sin(theta), 0, -std::cos(theta)));
      ASSERT_TRUE(expected) << options.curve << " " << theta;
      EXPECT_NEAR(beyond.radius(std::sin(theta), std::cos(theta)), *expected, 1e-12 * *expected) << options.curve << " " << theta;
    }
    // Continuously differentiable at the rim.
    EXPECT_NEAR(beyond.radius(std::sin(end), std::cos(end)), surface.r_max(), 1e-14);
    EXPECT_NEAR(beyond.slope(end), std::abs(surface.radial(last, end).dr), 1e-12);
  }
}

TEST(Continuation, EnclosesItsValuesAndDerivatives) {
  for (const SurfaceOptions& options : options_with_rims()) {
    const Surface surface(options, std::numbers::sqrt2);
    const std::size_t last = surface.branches().size() - 1;
    const Branch& branch = surface.branches()[last];
    for (const bool is_high : {false, true}) {
      const double end = is_high ? branch.theta_high : branch.theta_low, sign = is_high ? 1 : -1;
      if (end == 0 || end >= pi) continue; // on the axis
      const Continuation beyond(surface, last, is_high);
      const auto radius = [&](double theta) { return beyond.radius(std::sin(theta), std::cos(theta)); };
      const double near = end + sign * 0.01, far = end + sign * 0.05, h = 1e-4;
      const RadialEnclosure e = beyond.enclose(std::min(near, far), std::max(near, far));
      for (int i = 1; i < 20; ++i) {
        const double theta = near + (far - near) * i / 20;
        EXPECT_TRUE(e.r.lo <= radius(theta) && radius(theta) <= e.r.hi) << options.curve << " " << theta << ": " << radius(theta) << " not in " << e.r.lo << ", " << e.r.hi;
        const double slope = (radius(theta + h) - radius(theta - h)) / (2 * h), second = (radius(theta + h) - 2 * radius(theta) + radius(theta - h)) / (h * h);
        EXPECT_TRUE(e.dr.lo - 1e-6 <= slope && slope <= e.dr.hi + 1e-6) << options.curve;
        EXPECT_TRUE(e.d2r.lo - 1e-5 <= second && second <= e.d2r.hi + 1e-5) << options.curve;
      }
    }
  }
}

TEST(Continuation, DrawnBranchesEndWhereTheyWereAskedToOrBeforeBlindDirections) {
  SurfaceOptions options = options_of("1-r^2", 0.9);
  EXPECT_EQ(drawn_branch(Surface(options, 1.5), 0).theta_high, Surface(options, 1.5).branches()[0].theta_high);
  options.extension_deg = 12;
  const Surface surface(options, 1.5);
  EXPECT_NEAR(drawn_branch(surface, 0).theta_high - surface.branches()[0].theta_high, 12 * pi / 180, 1e-12);
  options.extension_deg = 180;
  const Branch widest = drawn_branch(Surface(options, 1.5), 0);
  EXPECT_LT(widest.theta_high, surface.blind().theta_low);
  EXPECT_GT(widest.radius_high, 2 * surface.r_max());
  options = options_of("sqrt(1-r^2)", std::nullopt); // its tangent is vertical
  options.extension_deg = 12;
  EXPECT_EQ(drawn_branch(Surface(options, 1.5), 0).theta_high, Surface(options, 1.5).branches()[0].theta_high);
}

} // namespace
} // namespace domewarp
