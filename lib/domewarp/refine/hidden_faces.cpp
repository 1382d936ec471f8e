// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/hidden_faces.h"

#include <algorithm>

#include <glm/geometric.hpp>

namespace domewarp {

namespace {

double nearest_of_segment(const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double length2 = glm::dot(d, d), t = length2 > 0 ? std::clamp(-glm::dot(a, d) / length2, 0.0, 1.0) : 0;
  return glm::length(a + t * d);
}

} // namespace

double nearest_distance(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double sides = std::min({nearest_of_segment(a, b), nearest_of_segment(b, c), nearest_of_segment(c, a)});
  const Vec3 normal = glm::cross(b - a, c - a);
  const bool holds_foot = glm::dot(normal, glm::cross(a, b)) >= 0 && glm::dot(normal, glm::cross(b, c)) >= 0 && glm::dot(normal, glm::cross(c, a)) >= 0;
  if (!holds_foot || !(glm::length(normal) > 0)) return sides;
  return std::min(sides, std::abs(glm::dot(normal, a)) / glm::length(normal));
}

bool is_hidden(const std::array<const MappedPoint*, 3>& corner, const RefineOptions& options) {
  const MappedPoint &a = *corner[0], &b = *corner[1], &c = *corner[2];
  const Vec2 low = glm::min(a.mapped.image, glm::min(b.mapped.image, c.mapped.image));
  const Vec2 high = glm::max(a.mapped.image, glm::max(b.mapped.image, c.mapped.image));
  return options.is_hidden(low, high, nearest_distance(a.eye, b.eye, c.eye));
}

} // namespace domewarp
