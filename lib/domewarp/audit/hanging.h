// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "domewarp/core/vectors.h"

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
/// @param tolerance largest distance from the edge, in the unit of the points
std::vector<HangingVertex> find_hanging_vertices(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 2>> edges,
                                                 std::span<const std::uint32_t> vertices, double tolerance);

/// Whether three points lie exactly on one line.
bool are_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

} // namespace domewarp
