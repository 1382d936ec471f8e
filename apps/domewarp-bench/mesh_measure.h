// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "domewarp/refine/levels.h"
#include "domewarp/refine/refine.h"

namespace domewarp::bench {

/// A surface to measure on, with the map that answers and the map that judges.
struct Display {
  std::string name;
  Surface surface;
  ImageMap map, exact; ///< as convert uses it; by the direct method
};
Display make_display(const std::string& name, const SurfaceOptions& options, const Raster& raster);

/// The surfaces of the design's table, whole visible cone.
std::vector<std::pair<std::string, SurfaceOptions>> surfaces();

/// A scene refined for the first branch of a display, over all of the visible cone, whatever the picture's rectangle.
/// With plain_tolerance_px every face is plain.
struct Refined {
  Soup soup;
  RefinedMesh mesh;
  double seconds = 0; ///< of refinement alone
};
Refined refine_whole(Soup soup, const Display& display, const Raster& raster, const RefineOptions& options);

/// Errors in pixels, by samples: 63 points of every edge, 66 inside every face, those that the surface shows.
struct Judged {
  std::size_t edges = 0, edge_violations = 0; ///< true above certified, or certified above the tolerance
  std::size_t face_violations = 0;            ///< true above the tolerance
  double certified = 0, edge_error = 0, face_error = 0; ///< largest
  double median_ratio = 0; ///< certified over true, over the edges
  double tight_ratio = 0;  ///< the same over the edges certified to at least half the tolerance
};
Judged judge(const Refined& refined, const Display& display, const Raster& raster, const RefineOptions& options);

/// Largest error in pixels over the points of a grid (4 parts) of every face, corners left out. Faces with a corner that is
/// not visible do not count.
double sampled_error(const RefinedMesh& mesh, const Display& display, const Raster& raster, Projection projection,
                     const std::function<bool(const RefinedFace&)>& counts);

} // namespace domewarp::bench
