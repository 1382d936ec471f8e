// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "domewarp/profile/surface.h"
#include "domewarp/refine/edge_oracle.h"
#include "domewarp/refine/isotropic.h"
#include "domewarp/refine/skips.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

enum class Subdivision {
  adaptive,  ///< as the tolerance needs
  isotropic, ///< the thesis' recursion by edge length (isotropic.h): cracks and loses triangles
  none,      ///< only clip (error as it comes)
};

/// What the colour of a written vertex can depend on, in eye space.
struct VertexToColour {
  int instance = 0, primitive = 0;   ///< Scene::instances, and within its mesh
  Vec3 eye = Vec3(0);                ///< where it is
  Vec3 normal = Vec3(0);             ///< NORMAL; without it that of the face
  Vec3 face_normal = Vec3(0);        ///< of a source triangle that it lies on, any length; of another the same side is seen
  Vec3 face_centre = Vec3(0);        ///< of that triangle
  Vec4 colour = Vec4(1);             ///< COLOR_0
};

/// The COLOR_0 of a vertex of the written triangles. A pure function, called from many threads.
using VertexColour = std::function<Vec4(const VertexToColour&)>;

struct RefineOptions {
  double tolerance_px = 0.5;         ///< largest displacement of any drawn point, pixels of the raster, > 0
  double texture_tolerance_px = 0;   ///< the same inside faces, where only what they show can slide, pixels; at least tolerance_px, 0: that
  double plain_tolerance_px = 0;     ///< the same inside plain faces (plain_faces.h), where that cannot be seen; at least both above, 0: the one above
  double depth_tolerance = 0.0025;   ///< largest relative error of the interpolated depth, > 0: 1 % put a train's wheels behind its rails
  Projection projection = Projection::perspective;
  double near = 0;                   ///< nothing nearer to the eye is drawn; 0: 1e-5 of the scene's extent
  std::size_t max_triangles = 50'000'000; ///< refinement stops here and says so
  bool source_attributes = false;    ///< adds _SOURCE_POSITION (eye space)
  double weld = 0;                   ///< positions this near are joined, scene units; 0: only those equal to the bit
  SkipOptions skip;
  /// Whether anybody reads an attribute of a primitive with this material (-1: the default one); empty: all are read.
  std::function<bool(int material, const std::string& attribute)> reads;
  /// Whether everything at `nearest` or farther (scene units) within a box of the image is hidden, as far as the picture
  /// can tell; empty: nothing is. Such faces are not written, and the edges of their neighbours are left open.
  std::function<bool(const Vec2& low, const Vec2& high, double nearest)> is_hidden;
  Subdivision subdivision = Subdivision::adaptive;
  IsotropicOptions isotropic;        ///< for Subdivision::isotropic
  EdgeCriterion criterion;           ///< splits more edges than the tolerance needs (not with Subdivision::isotropic)
  double criterion_px = 2;           ///< but none whose image is not longer than this, pixels
  VertexColour vertex_colour;        ///< if set, computes COLOR_0; vertices are doubled where their faces need two colours
};

struct RefineReport {
  std::size_t triangles_in = 0;      ///< drawn by the source
  std::size_t triangles_out = 0;
  std::size_t triangles_clipped = 0; ///< pieces outside the visible cones or inside the near sphere
  SkipReport skipped;
  std::size_t lines_in = 0, lines_out = 0;   ///< segments
  std::size_t points_in = 0, points_out = 0;
  std::size_t vertices = 0;
  std::size_t map_evaluations = 0;
  std::size_t levels = 0;            ///< of refinement, the deepest branch
  double error_px_max = 0, error_px_p99 = 0, error_px_mean = 0; ///< certified bounds of the edges drawn; nan when nothing bounds them
  double slide_px_max = 0;           ///< certified bound of the inner edges that the looser tolerances kept, which do not count above
  std::size_t plain_faces = 0;       ///< of the source, counted where plain_tolerance_px asks for them
  double depth_error_max = 0;        ///< certified bound of the relative error of the depth of every face drawn
  std::size_t uncertified_edges = 0; ///< drawn with a bound above the tolerance (a limit stopped them) or judged by samples (folds)
  std::size_t uncertified_faces = 0; ///< judged by samples: beside folds, and slivers close to the eye
  std::size_t t_junctions_in = 0;    ///< of the source, mended
  std::size_t t_junctions_out = 0;
  std::size_t near_misses = 0;       ///< pairs of ends of open edges of the source that are nearly but not equal
  std::size_t snapped = 0;           ///< points moved by RefineOptions::weld
  std::size_t open_edges_in = 0;     ///< of the source
  std::size_t open_edges = 0;        ///< drawn edges with one face that neither the source, the clip nor a culled face explains
  double max_gap_px = 0;             ///< widest gap that such edges can show: twice their error bound
  IsotropicReport isotropic;         ///< of Subdivision::isotropic, which bounds no error
  double near = 0;
  double smallest_depth = 0, largest_depth = 0; ///< of the depth coordinate written
  std::vector<std::string> limits_hit;
  double soup_ms = 0, levels_ms = 0, emit_ms = 0;
};

/// Splits every drawn triangle until the picture that a rasteriser draws from the warped vertices is nowhere farther
/// than the tolerance from the exact one, clips it to what each branch of the surface shows, and warps it.
///
/// Why no cracks: an edge has one record for the whole scene, keyed by its two positions; whether, where and how it is
/// split is a pure function of these (edge_oracle.h); the split point is stored once and every face uses it.
///
/// Lines are split and clipped by the same rules, so they stay on the triangle edges they lie on; points are mapped.
///
/// @return a scene of warped meshes in output space (perspective: w (x', y', -1); orthographic: (x', y', -depth)),
///         one mesh and instance per drawn instance of the source, with the camera that shows the picture, materials,
///         textures and images carried over. The same for any number of threads.
/// @throws Error(usage) when a tolerance is not positive and finite, or one for insides below that for outlines
Scene refine(const Scene& scene, const View& view, const Surface& surface, const ImageMap& map, const Raster& raster,
             const RefineOptions& options, RefineReport& report);

/// The same in less memory: the positions and indices of the source's triangles are freed
/// on the way, its images moved.
Scene refine(Scene&& scene, const View& view, const Surface& surface, const ImageMap& map, const Raster& raster,
             const RefineOptions& options, RefineReport& report);

} // namespace domewarp
