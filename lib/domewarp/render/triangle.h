// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this folder: one triangle against rays and points, in double precision.

#include <array>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "domewarp/core/vectors.h"

namespace domewarp {

/// The largest coordinate's absolute value.
double largest(const Vec3& v);

/// The corners of a triangle whose edges have moved outwards by `margin`; NaN (never hit) for one without area.
void inflate(const Vec3 (&v)[3], double margin, Vec3 (&out)[3]);

/// A triangle made ready for rays from the origin: the pyramid over it.
struct Pyramid {
  Vec3 sides[3];     ///< normals of the planes through the origin and the side opposite each corner
  double volume = 0; ///< six times the signed one
};

inline Pyramid make_pyramid(const Vec3 (&v)[3]) {
  const Vec3 c0 = glm::cross(v[1], v[2]);
  return {{c0, glm::cross(v[2], v[0]), glm::cross(v[0], v[1])}, glm::dot(v[0], c0)};
}

/// Relative error that float32 may make in the distance of a hit.
double distance_slack(const Vec3 (&v)[3]);

struct Crossing {
  double distance = 0;
  double det = 0; ///< direction . (unnormalised normal): negative when the ray meets the front
  double weights[3] = {};
};

/// Signed volumes decide. cross(a, b) and cross(b, a) are exact negatives, so two triangles with a common edge agree
/// about the side a ray from the origin passes on, and none slips between them. A ray exactly on the edge hits both.
inline bool intersect(const Vec3& direction, const Pyramid& pyramid, Crossing& crossing) {
  const double w0 = glm::dot(direction, pyramid.sides[0]), w1 = glm::dot(direction, pyramid.sides[1]),
               w2 = glm::dot(direction, pyramid.sides[2]);
  if (!((w0 >= 0 && w1 >= 0 && w2 >= 0) || (w0 <= 0 && w1 <= 0 && w2 <= 0))) return false;
  const double det = w0 + w1 + w2, share = 1 / det;
  const double distance = pyramid.volume * share;
  if (!(distance > 0) || !std::isfinite(distance)) return false;
  crossing = {distance, det, {w0 * share, w1 * share, w2 * share}};
  return true;
}

/// Barycentric weights of the projection of `p` onto the triangle's plane, if it is not farther from the triangle than
/// the tolerance.
std::optional<std::array<double, 3>> weights_near(const Vec3 (&v)[3], const Vec3& p, double tolerance);

} // namespace domewarp
