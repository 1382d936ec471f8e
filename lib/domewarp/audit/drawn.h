// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "domewarp/audit/picture.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

using Corners = std::array<std::uint32_t, 3>;
using Ends = std::array<std::uint32_t, 2>;

/// All drawn triangles of a scene, corner by corner.
struct Drawn {
  std::vector<Vec3> position;        ///< world space, one per drawn vertex, -0 written as +0
  std::vector<Corners> triangles;    ///< into `position`
  std::vector<std::uint8_t> single_sided; ///< one per triangle
};

Drawn collect_drawn(const Scene& scene);

/// Where a warped file's vertices came from.
struct Provenance {
  std::vector<Vec3> source;          ///< eye space, one per drawn vertex
  std::vector<std::uint32_t> branch; ///< of the surface, one per drawn vertex; 0 without a picture
  bool exact = false;                ///< from _SOURCE_POSITION (float32), else by the inverse map
};

/// From _SOURCE_POSITION where all primitives have it, else from `picture`; empty when there is neither.
Provenance find_provenance(const Scene& scene, const Drawn& drawn, const Picture* picture);

/// For every position the index of the first equal one with the same tag.
/// @param tags one per position, or empty
/// @param distinct how many differ
std::vector<std::uint32_t> first_equal(const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& tags, std::size_t& distinct);

/// Triangles of first_equal indices, without those that have two equal corners.
std::vector<Corners> weld_triangles(const std::vector<Corners>& triangles, const std::vector<std::uint32_t>& first);

/// Edges of welded triangles, by how many triangles are on them. A triangle of which two corners are one is on its only edge
/// twice: what its third side bounded is closed.
struct EdgeUse {
  std::vector<Ends> open;
  std::size_t non_manifold = 0;
};
EdgeUse use_edges(const std::vector<Corners>& triangles);

/// The ends of edges, each once, ascending.
std::vector<std::uint32_t> ends_of(const std::vector<Ends>& edges);

} // namespace domewarp
