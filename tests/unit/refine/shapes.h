// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/refine/refine.h"

namespace domewarp {

/// A scene of one double-sided mesh of loose triangles, three corners each, in world space = eye space.
Scene triangles_scene(const std::vector<Vec3f>& corners);

/// The six walls of the box from `low` to `high`, two triangles each, seen from inside.
Scene box_scene(const Vec3f& low, const Vec3f& high);

struct Conversion {
  Scene scene;
  RefineReport report;
};

/// Refines with source attributes, the eye at the origin looking along -z.
Conversion convert_shape(const Scene& scene, const SurfaceOptions& surface, RefineOptions options = {}, Raster raster = {1024, 1024});

SurfaceOptions curve(const std::string& expression);
SurfaceOptions lens(Lens kind, double fov_deg);

/// What bounds are tested on: surfaces of every kind, both projections.
struct Case {
  SurfaceOptions surface;
  Projection projection;
};
std::vector<Case> cases();

/// Largest distance in pixels between where the rasteriser puts a point of a written triangle and where the exact map
/// (direct method) puts its source position, over a barycentric grid of `n` parts of every triangle.
double measured_error_px(const Conversion& conversion, const SurfaceOptions& surface, Projection projection, const Raster& raster, int n);

/// Sum of the solid angles of the source triangles written, as seen from the eye.
double covered_solid_angle(const Scene& warped);

} // namespace domewarp
