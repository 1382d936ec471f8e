// SPDX-License-Identifier: Apache-2.0
// A ball that does not hold the eye is seen within a cone. The cone spans an interval of view angles and one of azimuths,
// so its image by one branch lies within a sector of a ring.
#include "domewarp/refine/view_cull.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "domewarp/transform/continuation.h"

namespace domewarp {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = 1e-9; ///< radians; far more than the arithmetic below loses

} // namespace

Ball bounding_ball(const Box& box, const Mat4& world, const View& view) {
  const auto corner = [&](int i) {
    const Vec3 p(i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y, i & 4 ? box.high.z : box.low.z);
    return to_eye(view, to_world(world, Vec3f(p)));
  };
  Ball ball;
  for (int i = 0; i < 8; ++i) ball.centre += corner(i) / 8.0;
  for (int i = 0; i < 8; ++i) ball.radius = std::max(ball.radius, glm::length(corner(i) - ball.centre));
  ball.radius *= 1 + 1e-12;
  return ball;
}

ViewCull::ViewCull(const Surface& surface, const Vec2& half_extent) : surface_(surface), half_extent_(half_extent) {}

bool ViewCull::may_be_seen(const Ball& ball) const {
  const double distance = glm::length(ball.centre);
  if (!(distance > ball.radius)) return true;
  const DirectionSector sector = sector_of({ball.centre / distance, std::asin(ball.radius / distance)});
  const double low = sector.theta_low, high = sector.theta_high;
  for (std::size_t b = 0; b < surface_.branches().size(); ++b) {
    const Branch branch = drawn_branch(surface_, b);
    if (low > branch.theta_high + rounding || high < branch.theta_low - rounding) continue;
    const auto [near, far] = std::minmax({radius(b, std::max(low, branch.theta_low)), radius(b, std::min(high, branch.theta_high))});
    if (meets_rectangle(half_extent_, near * (1 - rounding), far * (1 + rounding), sector)) return true;
  }
  return false;
}

double ViewCull::radius(std::size_t branch, double theta) const {
  const Branch& range = surface_.branches()[branch];
  if (theta >= range.theta_low && theta <= range.theta_high) return surface_.radius(branch, std::sin(theta), std::cos(theta));
  return Continuation(surface_, branch, theta > range.theta_high).radius(std::sin(theta), std::cos(theta));
}

DirectionSector sector_of(const DirectionCone& cone) {
  const double half = cone.half_angle + rounding;
  const double theta = std::atan2(std::hypot(cone.axis.x, cone.axis.y), -cone.axis.z);
  DirectionSector sector{std::max(theta - half, 0.0), std::min(theta + half, pi), std::atan2(cone.axis.y, cone.axis.x), pi};
  const bool holds_axis = theta <= half || theta + half >= pi;
  if (!holds_axis) sector.half_azimuth = std::asin(std::min(1.0, std::sin(half) / std::sin(theta))) + rounding;
  return sector;
}

bool meets_rectangle(const Vec2& half_extent, double radius_low, double radius_high, const DirectionSector& sector) {
  for (int side = 0; side < 4; ++side) {
    // Farthest of the sector's directions from this side's normal.
    const double apart = std::min(pi, std::abs(std::remainder(sector.azimuth - side * pi / 2, 2 * pi)) + sector.half_azimuth);
    const double least = std::cos(apart) * (apart < pi / 2 ? radius_low : radius_high);
    if (least > half_extent[side % 2]) return false;
  }
  return true;
}

} // namespace domewarp
