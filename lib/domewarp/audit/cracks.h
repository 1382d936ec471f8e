// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "domewarp/audit/drawn.h"

namespace domewarp {

/// What a warped file's provenance tells: faces that met in the source must still meet in the picture.
struct CrackReport {
  bool exact_provenance = false;    ///< from _SOURCE_POSITION; else positions were mapped back and torn ones cannot be told
  bool source_known = false;        ///< open edges of the source are told apart
  std::size_t torn_positions = 0;   ///< source positions that one branch draws at two places more than a thousandth of a pixel apart
  std::size_t open_edges = 0;       ///< in source space, that neither clipping nor (where it is known) the source explains
  std::size_t t_junctions = 0;      ///< vertices inside an open edge, more than a thousandth of a pixel off it
  double max_gap_px = 0;            ///< farthest that a T-junction is from its edge, or a torn position from itself
  double mean_gap_px = 0;           ///< over T-junctions
  double gap_area_px2 = 0;          ///< between the edges and the T-junctions on them
  std::size_t flips = 0;            ///< triangles that turn the wrong way, thicker than a thousandth of a pixel
};

/// The source scene as the eye sees it.
struct SourceMesh {
  std::vector<Vec3> points;         ///< eye space
  std::vector<Corners> triangles;   ///< without zero-length edges
  std::vector<std::uint8_t> is_back; ///< per triangle: single-sided and seen from behind
  std::vector<Ends> open;           ///< edges of one triangle, or of one that is seen from the front
};
SourceMesh make_source_mesh(const Scene& scene, const View& view);

/// @param source may be null
/// @param picture may be null: nothing is known of clipping then
CrackReport find_cracks(const Drawn& drawn, const Provenance& provenance, bool perspective, int height, const Picture* picture,
                        const SourceMesh* source);

} // namespace domewarp
