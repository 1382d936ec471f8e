// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "domewarp/transform/image_map.h"
#include "domewarp/transform/polar.h"

namespace domewarp {

namespace {

// Whether the branch shows the direction of p. Doubles decide unless p is within their rounding of the cone's edge.
// @param scaled p by a power of two, of moderate length
bool shows(const Surface& surface, std::size_t index, const BranchMap& branch, const Vec3& p, const Vec3& scaled) {
  const double margin = 1e-14 * glm::length(scaled);
  const Vec2 within = branch.inside(scaled);
  if (within.x < -margin || within.y < -margin) return false;
  return (within.x > margin && within.y > margin) || surface.shows(index, p);
}

bool is_finite(const Vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

} // namespace

const char* to_string(PointState state) {
  switch (state) {
  case PointState::visible: return "visible";
  case PointState::extended: return "extended";
  default: return "blind";
  }
}

const char* to_string(Method method) {
  switch (method) {
  case Method::automatic: return "auto";
  case Method::direct: return "direct";
  default: return "lut";
  }
}

ImageMap make_image_map(const Surface& surface, Method method, std::size_t points) {
  ImageMap map;
  map.branches.reserve(surface.branches().size());
  for (std::size_t i = 0; i < surface.branches().size(); ++i) map.branches.emplace_back(surface, i, method, points);
  return map;
}

ImagePoint project(const Surface& surface, const ImageMap& map, const Vec3& p) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const ImagePoint blind{nan, nan, std::hypot(p.x, p.y, p.z), PointState::blind};
  if (!is_finite(p) || p == Vec3(0)) return blind;
  const Polar q = polar(p);
  const Vec3 scaled(q.x, q.y, -q.z);
  for (std::size_t i = 0; i < map.branches.size(); ++i) {
    if (!shows(surface, i, map.branches[i], p, scaled)) continue;
    const Vec2 image = map.branches[i].image(scaled);
    return {image.x, image.y, blind.depth, PointState::visible};
  }
  const std::optional<double> radius = surface.extended_radius(p);
  if (!radius) return blind;
  const Vec2 image = *radius * side(q);
  return {image.x, image.y, blind.depth, PointState::extended};
}

bool unproject(const Surface& surface, const Vec2& image, Vec3& direction) {
  // The rim's points round to either side of it.
  constexpr double rounding = 2e-15;
  double radius = std::hypot(image.x, image.y);
  if (radius > surface.r_max() && radius <= surface.r_max() * (1 + rounding)) radius = surface.r_max();
  const std::optional<Vec2> way = surface.direction(radius);
  if (!way) return false;
  const Vec2 around = side(polar({image.x, image.y, 0}));
  direction = {way->x * around.x, way->x * around.y, -way->y};
  return true;
}

} // namespace domewarp
