// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "domewarp/mesh/topology.h"

namespace domewarp {

/// What only walking around a mesh can tell.
struct MeshShape {
  std::size_t vertices = 0, edges = 0, faces = 0; ///< of the half-edge structure
  std::size_t boundary_loops = 0;
  std::size_t detached_faces = 0; ///< faces a half-edge structure cannot take: they stand on vertices of their own
  long long euler_characteristic() const {
    return static_cast<long long>(vertices) - static_cast<long long>(edges) + static_cast<long long>(faces);
  }
};

/// Builds OpenMesh's half-edge structure of welded triangles and walks its boundaries. Refinement without clipping must
/// leave the Euler characteristic and the number of boundary loops as they are.
/// @param point_count every id in `triangles` is below it; points without a face do not count
MeshShape walk_half_edges(std::uint32_t point_count, std::span<const Triangle> triangles);

} // namespace domewarp
