// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "domewarp/scene/scene.h"

namespace domewarp {

/// What a warped file's provenance (_SOURCE_POSITION) adds: faces that met in the source must still meet in the picture.
struct CrackReport {
  std::size_t torn_positions = 0;   ///< source positions that appear at two different places of the picture
  std::size_t t_junctions = 0;      ///< vertices inside open edges, in source space
  std::size_t open_edges = 0;       ///< in source space; the rim of the visible region and culled neighbours included
  double max_gap_px = 0;            ///< largest distance in the picture that these open
};

/// Mesh statistics of all drawn triangles of a scene together, welded by exact world position.
struct InspectReport {
  std::size_t meshes = 0, instances = 0, primitives = 0, materials = 0;
  std::size_t triangles = 0;        ///< drawn
  std::size_t vertices = 0;         ///< drawn, as stored: seams count twice
  std::size_t unique_positions = 0;
  std::size_t open_edges = 0;       ///< of one triangle
  std::size_t non_manifold_edges = 0; ///< of three or more
  std::size_t degenerate = 0;       ///< triangles with two equal corners or exactly on one line
  std::size_t duplicate = 0;        ///< triangles with the three corners of an earlier one
  std::size_t t_junctions = 0;      ///< vertices of open edges inside another open edge, within 1e-5 of the diagonal
  double max_gap = 0;               ///< largest distance of such a vertex from its edge, scene units
  std::optional<CrackReport> cracks; ///< only for files with _SOURCE_POSITION
};

/// Shares no code with refinement: edges by sorting, T-junctions by CGAL. Degenerate triangles have no edges here.
/// @param height rows of the picture, for gaps in pixels; used for files with _SOURCE_POSITION only
InspectReport inspect(const Scene& scene, int height);

std::string to_json(const InspectReport& report);
std::string to_text(const InspectReport& report);

} // namespace domewarp
