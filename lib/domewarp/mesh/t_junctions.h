// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/mesh/topology.h"

namespace domewarp {

/// A point that lies inside an open edge of another face: invisible while the mesh is flat, a crack once it is warped.
struct TJunction {
  std::uint32_t edge = 0;  ///< index into MeshTopology::edges, an open edge
  std::uint32_t point = 0;
  double t = 0;            ///< where on the edge, from Edge::a to Edge::b, in (0, 1)
};

/// Finds the ends of open edges that lie inside other open edges.
/// @param tolerance largest distance from the edge, relative to the edge's length plus the size of its coordinates in
///                  four float32 units in the last place: what a modeller's rounding leaves
/// @return sorted by edge, then by t
std::vector<TJunction> find_t_junctions(std::span<const Vec3> points, const MeshTopology& topology, double tolerance = 1e-6);

/// Pairs of different points, ends of open edges, so close that they were probably meant to be one: within eight float32
/// units in the last place of their coordinates. The warp keeps whatever gap there is between them.
/// @param offset size of what was subtracted from the coordinates since they were float32, scene units
std::size_t count_near_misses(std::span<const Vec3> points, const MeshTopology& topology, double offset);

} // namespace domewarp
