// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "domewarp/audit/cracks.h"

namespace domewarp {

/// What points sampled on the source's triangles find among the warped ones.
struct CoverageReport {
  std::size_t samples = 0;          ///< that the picture must show
  std::size_t lost = 0;             ///< on no warped triangle
  std::size_t overlapping = 0;      ///< on more warped triangles than the source has there
  double lost_area_px2 = 0;         ///< image area that the lost samples stand for
  double error_px_max = 0, error_px_mean = 0; ///< between where a sample is drawn and where the exact map puts it
};

/// Deterministic samples, at least one on every triangle that is seen while `budget` lasts, the rest by solid angle.
/// Found by CGAL's AABB tree over the warped triangles' source positions; exact intersections.
CoverageReport measure_coverage(const Drawn& drawn, const Provenance& provenance, const Picture& picture, const SourceMesh& source,
                                std::size_t budget);

} // namespace domewarp
