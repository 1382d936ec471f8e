// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this folder: one triangle against rays and points, in double precision.

#include <array>
#include <optional>

#include "domewarp/core/vectors.h"

namespace domewarp {

/// The largest coordinate's absolute value.
double largest(const Vec3& v);

/// The corners of a triangle whose edges have moved outwards by `margin`; NaN (never hit) for one without area.
void inflate(const Vec3 (&v)[3], double margin, Vec3 (&out)[3]);

struct Crossing {
  double distance = 0;
  double det = 0; ///< direction . (unnormalised normal): negative when the ray meets the front
  double weights[3] = {};
  double slack = 0; ///< relative error that float32 may make in the distance
};

/// Signed volumes decide. cross(a, b) and cross(b, a) are exact negatives, so two triangles with a common edge agree
/// about the side a ray from the origin passes on, and none slips between them. A ray exactly on the edge hits both.
bool intersect(const Vec3& direction, const Vec3& v0, const Vec3& v1, const Vec3& v2, Crossing& crossing);

/// Barycentric weights of the projection of `p` onto the triangle's plane, if it is not farther from the triangle than
/// the tolerance.
std::optional<std::array<double, 3>> weights_near(const Vec3 (&v)[3], const Vec3& p, double tolerance);

} // namespace domewarp
