// SPDX-License-Identifier: Apache-2.0
#include "domewarp/audit/picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace domewarp {

namespace {

/// Smallest distance of an image radius from an end of the branch, positive inside.
double inside_radii(const Branch& branch, double radius) {
  const auto [least, largest] = std::minmax(branch.radius_low, branch.radius_high);
  return std::min(least > 0 ? radius - least : 1.0, largest - radius);
}

double view_angle(const Vec3& eye) { return std::atan2(std::hypot(eye.x, eye.y), -eye.z); }

} // namespace

double inside_angles(const Branch& branch, const Vec3& eye) {
  constexpr double pi = std::numbers::pi;
  const double theta = view_angle(eye), low = branch.theta_low > 0 ? theta - branch.theta_low : pi;
  return std::min(low, branch.theta_high < pi ? branch.theta_high - theta : pi);
}

Vec3 source_of(const Picture& picture, const Vec3& position) {
  const Vec2 image = drawn_at(position, picture.perspective);
  Vec3 direction;
  const double radius = glm::length(image), r_max = picture.surface.r_max();
  if (!unproject(picture.surface, radius > r_max ? image * (r_max / radius) : image, direction)) return Vec3(0);
  if (!picture.perspective) return direction * -position.z;
  return direction * (-position.z / picture.map.branches[picture.surface.branch_at(radius)].factors(direction).g);
}

bool is_at_boundary(const Picture& picture, std::size_t branch, const Vec3& eye, double margin) {
  const Branch& b = picture.map.branches[branch].branch();
  const double radius = glm::length(picture.map.branches[branch].image(eye));
  return std::abs(inside_angles(b, eye)) <= margin || std::abs(inside_radii(b, radius)) <= margin ||
         std::abs(glm::length(eye) - picture.near) <= margin * picture.near;
}

bool is_near_rim(const Picture& picture, std::size_t branch, const Vec3& eye) {
  const BranchMap& map = picture.map.branches[branch];
  return std::abs(inside_radii(map.branch(), glm::length(map.image(eye)))) <= picture.rim_px * pixel_size(picture.raster);
}

bool is_shown(const Picture& picture, std::size_t branch, const Vec3& eye, double margin) {
  if (inside_angles(picture.map.branches[branch].branch(), eye) < margin) return false;
  if (glm::length(eye) < picture.near * (1 + margin)) return false;
  const Vec2 image = picture.map.branches[branch].image(eye);
  return std::abs(image.x) < aspect(picture.raster) - margin && std::abs(image.y) < 1 - margin;
}

double pixels_per_steradian(const Picture& picture, std::size_t branch, const Vec3& eye) {
  const double theta = std::max(view_angle(eye), 1e-9);
  const RadialJet jet = picture.surface.radial(branch, theta);
  const double px = pixel_size(picture.raster);
  return std::abs(jet.r * jet.dr) / std::sin(theta) / (px * px);
}

} // namespace domewarp
