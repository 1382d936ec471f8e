// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/profile/surface.h"

namespace domewarp {

/// One boundary of what a branch shows: the cone of its smallest or largest view angle, or the near sphere.
struct Boundary {
  enum class Kind { low_cone, high_cone, near_sphere } kind;
  double sine = 0, cosine = 0; ///< of the cone's half angle
  double radius = 0;           ///< of the sphere
};

/// -1 outside, 0 on the boundary, +1 inside; one entry per boundary of the region.
using Sides = std::array<std::int8_t, 3>;

/// Whether two points lie on one boundary: what joins them is a chord of the rim.
bool share_boundary(const Sides& p, const Sides& q);

/// The directions and distances that a branch shows: theta_low <= theta <= theta_high, rho >= near.
struct VisibleRegion {
  std::vector<Boundary> boundaries; ///< at most three, in a fixed order
};

/// The image of the direction straight behind is a circle, which no vertex can be: a lens of 360 degrees is cut this
/// close to it (radians; 0.07 px at 4096 rows).
inline constexpr double blind_angle = 1e-4;
double highest_angle(const Branch& branch);

/// @param near radius of the sphere around the eye in which nothing is drawn, > 0, scene units
VisibleRegion make_visible_region(const Branch& branch, double near);

/// Positive inside, negative outside, continuous: rho sin(theta_c - theta) for a cone (valid for every half angle,
/// no nappe cases), rho - radius for the sphere.
double signed_distance(const Boundary& boundary, const Vec3& p);

/// Sides of a point. Points within a few units in the last place of a boundary count as on it.
Sides sides_of(const VisibleRegion& region, const Vec3& p);

/// Where the segment from a (inside or outside) to b (on the other side) meets the boundary; t in (0, 1).
double crossing(const Boundary& boundary, const Vec3& a, const Vec3& b);

/// Where theta (cones) or rho (sphere) has its only extremum on the segment, if strictly between the ends.
std::optional<double> extremum(const Boundary& boundary, const Vec3& a, const Vec3& b);

/// The point of the closed segment at t, exact at both ends and the same for either end first when t is 1/2.
inline Vec3 point_at(const Vec3& a, const Vec3& b, double t) { return a * (1 - t) + b * t; }

} // namespace domewarp
