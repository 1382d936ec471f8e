// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "domewarp/audit/cracks.h"

namespace domewarp {

/// One-sided Hausdorff distance from the exact warp of the source to the warped mesh, in the space (x', y', third), in
/// pixels, in which every drawn triangle is flat. The third coordinate counts depth: for perspective output 250 px times
/// the nearest depth over the depth, so that 0.2 % of it are half a pixel at the nearest point and less elsewhere; for
/// orthographic output 250 px times the depth over the largest one.
struct HausdorffReport {
  double distance_px = 0;           ///< the distance is at most this, and at least this less `error_px`
  double error_px = 0;              ///< of the measure
  std::size_t exact_triangles = 0;  ///< into which the source was cut, each flat to a tenth of `error_px` at its sides' middles
};

/// By CGAL's bounded-error algorithm. The exact warp is cut into pieces whose corners are exact; pieces that are not shown
/// whole (at the rim, at the picture's edge) do not count. Slow: seconds to minutes.
/// @param error_px > 0
/// @throws Error(usage) when the exact warp would need more than 5 million pieces
HausdorffReport measure_hausdorff(const Drawn& drawn, const Picture& picture, const SourceMesh& source, double error_px);

} // namespace domewarp
