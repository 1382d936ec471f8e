// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "domewarp/render/lights.h"
#include "domewarp/render/ray_geometry.h"
#include "domewarp/render/shading.h"
#include "domewarp/scene/view.h"

namespace domewarp {

/// The triangles with what lights them.
struct RayWorld {
  const View& view;
  const RayGeometry& geometry;
  Lighting lighting;
  bool shadows = false;
  double near = 0; ///< nothing is hit nearer to the eye than this
};

/// What came along one ray from the eye.
struct RaySample {
  Vec4 light = Vec4(0); ///< linear, multiplied by alpha, front to back
  RayHit first;         ///< the nearest hit, `part` null when there is none
  unsigned rays = 0;    ///< traced for it
};

/// Traces at most RayGeometry::packet_size unit directions; quickest where they go the same way.
void trace(const RayWorld& world, std::span<const Vec3> directions, RaySample* samples);

/// `light` of shading.h with the shadows of the world, if it has any. @param rays raised by the number of shadow rays
Vec3 light_at(const RayWorld& world, const Look& look, const SurfacePoint& point, unsigned& rays);

/// What shading sees at a hit.
SurfacePoint surface_point(const RayWorld& world, const RayHit& hit);

} // namespace domewarp
