// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "domewarp/transform/image_map.h"
#include "domewarp/transform/polar.h"

namespace domewarp {

namespace {

bool is_finite(const Vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

} // namespace

const char* to_string(PointState state) {
  switch (state) {
  case PointState::visible: return "visible";
  case PointState::extended: return "extended";
  default: return "blind";
  }
}

ImageMap make_image_map(const Surface& surface, Method method) {
  ImageMap map;
  map.branches.reserve(surface.branches().size());
  for (std::size_t i = 0; i < surface.branches().size(); ++i) map.branches.emplace_back(surface, i, method);
  return map;
}

ImagePoint project(const Surface& surface, const ImageMap& map, const Vec3& p) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const ImagePoint blind{nan, nan, std::hypot(p.x, p.y, p.z), PointState::blind};
  if (!is_finite(p) || p == Vec3(0)) return blind;
  const Polar q = polar(p);
  const Vec3 scaled(q.x, q.y, -q.z); // signs of inside() survive where p is denormal
  for (const BranchMap& branch : map.branches) {
    const Vec2 within = branch.inside(scaled);
    if (within.x < 0 || within.y < 0) continue;
    const Vec2 image = branch.image(scaled);
    return {image.x, image.y, blind.depth, PointState::visible};
  }
  const std::optional<double> radius = surface.extended_radius(q.r / q.rho, q.z / q.rho);
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
