// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/picture_cull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>

#include "domewarp/refine/picture_rectangle.h"
#include "domewarp/refine/view_cull.h"

namespace domewarp {

namespace {

constexpr double widest = 1.4; ///< radians; a wider cone is not asked about

} // namespace

bool PictureCull::straddles(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c) const {
  std::array<Vec2, 3> images;
  std::size_t mapped = 0;
  for (const MappedPoint* p : {&a, &b, &c})
    if (*std::min_element(p->sides.begin(), p->sides.end()) >= 0) images[mapped++] = p->mapped.image;
  return !is_beyond(std::span(images).first(mapped), half_extent_);
}

bool PictureCull::may_be_seen(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c) const {
  const std::array<const MappedPoint*, 3> corners{&a, &b, &c};
  if (straddles(a, b, c)) return true;
  std::array<Vec3, 3> direction;
  for (int k = 0; k < 3; ++k) {
    if (!(corners[k]->rho > 0)) return true;
    direction[k] = corners[k]->eye / corners[k]->rho;
  }
  const Vec3 sum = direction[0] + direction[1] + direction[2];
  if (!(glm::dot(sum, sum) > 0.1)) return true;
  DirectionCone cone{glm::normalize(sum), 0};
  for (const Vec3& d : direction) cone.half_angle = std::max(cone.half_angle, 2 * std::asin(std::min(1.0, 0.5 * glm::length(d - cone.axis))));
  if (cone.half_angle > widest) return true;
  const DirectionSector sector = sector_of(cone);
  const Branch& branch = map_.branch();
  if (sector.theta_low > branch.theta_high || sector.theta_high < branch.theta_low) return true; // clipping's business
  const auto [low, high] = std::minmax({radius(std::max(sector.theta_low, branch.theta_low)), radius(std::min(sector.theta_high, branch.theta_high))});
  return meets_rectangle(half_extent_, low * (1 - 1e-9), high * (1 + 1e-9), sector);
}

double PictureCull::radius(double theta) const {
  const double sine = std::sin(theta);
  return map_.factors({sine, 0, -std::cos(theta)}).k * sine;
}

} // namespace domewarp
