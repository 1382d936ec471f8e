// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
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

/// The edges of one triangle alone, sorted by a, then b: what build_topology lists with faces == 1. Where most edges are
/// passed once in each direction it takes a fraction of the time, and 8 bytes per point.
/// @param triangle of an index below `count`; a pure function, called from many threads
std::vector<MeshTopology::Edge> find_open_edges(std::uint32_t point_count, std::size_t count, const std::function<Triangle(std::size_t)>& triangle);

/// The edge from p to q, in either order, of a sorted list, or null.
const MeshTopology::Edge* find_edge(std::span<const MeshTopology::Edge> edges, std::uint32_t p, std::uint32_t q);

} // namespace domewarp
