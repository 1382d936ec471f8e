// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/refine/edge_oracle.h"
#include "domewarp/refine/refine.h"

namespace domewarp {

struct LineCounts {
  std::size_t lines = 0, points = 0; ///< segments and points drawn by the source
  double extent = 0;                 ///< largest distance of one of their vertices from the eye
};

LineCounts count_lines(const Scene& scene, const View& view);

/// Appends what one branch shows of the scene's lines and points to `out`, as `emit` does for triangles. A segment is
/// split where the oracle splits the edge between its ends, so a line on a triangle's edge gets the same points.
void emit_lines(const Scene& scene, const View& view, const EdgeOracle& oracle, const Raster& raster,
                const RefineOptions& options, Scene& out, RefineReport& report);

} // namespace domewarp
