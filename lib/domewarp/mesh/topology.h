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
  std::vector<Edge> edges;      ///< sorted by a, then b
  std::vector<std::array<std::uint32_t, 3>> edges_of; ///< per triangle: edge from corner i to corner i + 1
};

/// Matches the sides of welded triangles. Edges of three or more faces, Moebius strips, bow-ties, mirrored and duplicate
/// faces are edges like any other. Parallel; the same for any number of threads.
/// @param point_count every id in `triangles` is below it
MeshTopology build_topology(std::uint32_t point_count, std::span<const Triangle> triangles);

/// Drops the triangles whose flag is 0, and the edges that only they had.
MeshTopology keep_faces(const MeshTopology& topology, std::span<const std::uint8_t> kept);

} // namespace domewarp
