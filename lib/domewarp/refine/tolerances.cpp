// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/tolerances.h"

#include <algorithm>

namespace domewarp {

namespace {

/// Edges are refined to this share of the tolerance, faces to the tolerance less the rounding to float32: the bound of a
/// face cannot fall below that of its sides, and without the difference no vertex inside would ever be enough.
constexpr double edge_share = 0.97;

/// A face of three equal sides sags a third more than they do. Of 0.75 to 1 this share needed the fewest triangles: the bundled
/// scenes have 1.6 % more than without a bound for faces.
constexpr double depth_share = 0.95;

/// Image coordinates are quotients of two float32 numbers; r_max is at most a few image units.
constexpr double file_rounding = 0x1p-22;

constexpr double turned_px = 5e-4; ///< half of what the audit calls turned

} // namespace

OracleOptions oracle_options(const RefineOptions& options, const Raster& raster) {
  const double tolerance = options.tolerance_px * pixel_size(raster), edge = edge_share * tolerance;
  const double texture = edge_share * std::max(options.tolerance_px, options.texture_tolerance_px) * pixel_size(raster);
  const double plain = std::max(texture, edge_share * options.plain_tolerance_px * pixel_size(raster));
  OracleOptions oracle{edge, std::max(edge, tolerance - file_rounding), depth_share * options.depth_tolerance, options.projection,
                       options.depth_tolerance, options.criterion, options.criterion_px * pixel_size(raster), std::max(turned_px * pixel_size(raster), file_rounding),
                       texture, plain};
  if (options.subdivision == Subdivision::none) oracle.tolerance = oracle.face_tolerance = oracle.depth_tolerance = oracle.face_depth_tolerance = oracle.turned_thickness = 1e30;
  return oracle;
}

} // namespace domewarp
