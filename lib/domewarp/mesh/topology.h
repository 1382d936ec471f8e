// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace domewarp {

/// Three point ids, counter-clockwise, all different.
using Triangle = std::array<std::uint32_t, 3>;

/// One record per geometric edge of a triangle soup, whatever the number of faces on it.
struct MeshTopology {
  struct Edge {
    std::uint32_t a = 0, b = 0; ///< point ids, a < b
    std::uint32_t faces = 0;    ///< how many triangles use it: 1 open, 2 regular, more non-manifold
  };
  std::vector<Edge> edges;
  std::vector<std::array<std::uint32_t, 3>> edges_of; ///< per triangle: edge from corner i to corner i + 1
};

/// Builds the half-edge structure (OpenMesh) of welded triangles and reads one edge record per pair of points from it.
/// Edges of three or more faces, Moebius strips, bow-ties, mirrored and duplicate faces are fine: a face that a
/// half-edge structure cannot take joins through points of its own, and edges between the same points share one record.
/// @param point_count every id in `triangles` is below it
MeshTopology build_topology(std::uint32_t point_count, std::span<const Triangle> triangles);

} // namespace domewarp
