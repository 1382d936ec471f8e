// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/convert/bake.h"
#include "domewarp/convert/display.h"
#include "domewarp/core/progress.h"
#include "domewarp/profile/surface.h"
#include "domewarp/refine/refine.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

/// How the written file is lit.
enum class Shading {
  keep,  ///< normals and directional lights in eye space
  unlit, ///< colours as they are: every material is marked KHR_materials_unlit
  bake,  ///< light in COLOR_0 (bake.h), every material marked KHR_materials_unlit
};

/// Everything that decides what a conversion looks like.
struct ConvertOptions {
  ViewOptions view;
  SurfaceOptions surface;
  Raster raster;
  Method method = Method::automatic;
  RefineOptions refine;
  Shading shading = Shading::keep;
  BakeOptions bake;             ///< for Shading::bake
  bool cull_hidden = false;     ///< leave out what no ray at twice the picture's density reaches (hidden.h)
};

/// How many points mapping the scene takes at least, about: what Method::automatic goes by. Refinement evaluates the map
/// at 3 to 50 points for each vertex of the source (the bundled scenes), and a closed box of eight vertices at thousands.
std::size_t expected_points(const Scene& scene, const ConvertOptions& options);

/// What a conversion did; `to_json` (report.h) is its written form.
struct ConvertReport {
  std::string input, output;    ///< names of the files, of run_job
  std::string animation;        ///< that posed the scene, of run_job
  double time = 0;              ///< of the animation, seconds
  RefineReport refine;
  View view;                    ///< as resolved
  double r_max = 0;
  RadiusLimit r_max_limit = RadiusLimit::screen;
  std::vector<Branch> branches;
  double extension_deg = 0;     ///< how far --boundary tangent goes on beyond r_max
  std::vector<TableReport> tables; ///< one per branch
  std::size_t expected_points = 0; ///< what Method::automatic went by
  std::vector<std::string> warnings;
  std::vector<std::string> dropped_extensions;
  std::vector<std::string> dropped_extras; ///< "cameras", "skins", ...: whose extras are not carried over
  double packing_px = 0;        ///< how far rounding in the written file moves a vertex at most (packing_error.h)
  std::size_t packing_mended = 0; ///< triangles that this rounding turned over, turned back (packed_flips.h)
  std::size_t packing_turned = 0; ///< and those that stay turned
  BakeReport baked;             ///< of Shading::bake
  double map_ms = 0;
  double hidden_ms = 0;         ///< rays of cull_hidden
  double total_ms = 0;
  double peak_memory_mb = 0;    ///< of the process so far
};

/// The whole job: a scene in, the pre-warped scene out, `Scene::extras` filled in so that the file says how it was made
/// (record.h). A tolerance that could not be reached shows in report.refine.limits_hit and error_px_max.
/// @throws Error(usage) for a view, surface, raster or tolerance that cannot work
Scene convert(const Scene& scene, const ConvertOptions& options, ConvertReport& report, const Progress& progress = {});

/// The same with a display that was made before, of the same surface, raster and method.
Scene convert(const Scene& scene, const ConvertOptions& options, const Display& display, ConvertReport& report,
              const Progress& progress = {});

/// The same in less memory: frees the positions and indices of the scene's triangles on the way, unless light is baked.
Scene convert(Scene&& scene, const ConvertOptions& options, const Display& display, ConvertReport& report, const Progress& progress = {});

/// Whether the promise of the tolerance was kept.
bool is_kept(const ConvertReport& report, const ConvertOptions& options);

/// What was not kept, in one sentence without a file's name.
std::string broken_promise(const ConvertReport& report, const ConvertOptions& options);

} // namespace domewarp
