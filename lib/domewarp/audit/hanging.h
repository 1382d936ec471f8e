// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "domewarp/audit/drawn.h"

namespace domewarp {

/// A vertex inside an edge it is not an end of.
struct HangingVertex {
  std::uint32_t edge = 0, vertex = 0; ///< indices of the arguments
  double t = 0;                       ///< along the edge
};

/// Candidates by CGAL's box intersection, then distances; a vertex exactly on the edge's line (CGAL's exact predicate)
/// counts whatever the tolerance.
/// @param edges pairs of indices into `points`
/// @param vertices indices into `points`
/// @param tolerance largest distance from an edge of these two ends, in the unit of the points
/// @return sorted by edge, then t
std::vector<HangingVertex> find_hanging_vertices(std::span<const Vec3> points, std::span<const Ends> edges,
                                                 std::span<const std::uint32_t> vertices,
                                                 const std::function<double(const Vec3&, const Vec3&)>& tolerance);

/// Whether three points lie exactly on one line.
bool are_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

/// Sign of the determinant of three vectors, exactly: how a triangle turns as seen from the origin.
int turn_from_origin(const Vec3& a, const Vec3& b, const Vec3& c);

/// Sign of twice the area of three points of the plane, exactly.
int turn(const Vec2& a, const Vec2& b, const Vec2& c);

} // namespace domewarp
