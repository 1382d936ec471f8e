// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "domewarp/profile/surface.h"
#include "domewarp/render/frame.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"

namespace domewarp {

struct RayTraceOptions {
  double near = 0;                                       ///< nothing is hit nearer to the eye than this
  bool unlit = false;                                    ///< colours without any shading, as with `convert --unlit`
  std::array<std::uint8_t, 4> background = {0, 0, 0, 0}; ///< sRGB, straight alpha
  std::string embree; ///< Embree's device configuration, "isa=sse4.2" for instance; the picture is the same
};

/// The reference: the picture of a scene on the surface, one ray through every pixel centre, from the original
/// geometry. A pixel shows the direction that Surface::direction gives for its radius, so every branch of a
/// multi-valued curve is drawn; beyond r_max there is background. Positions and depths are computed in double
/// precision; among equally near triangles the smallest (object, triangle) is seen. Back faces of single-sided
/// materials, masked texels and blended fragments of no visible alpha do not count as hits. Blended surfaces are
/// composed front to back, at most 128 of them; position, ids and depth are those of the nearest one. The same frame
/// comes out on any CPU and with any number of threads. Shading: see shading.h.
/// @throws Error(input) when the scene is inconsistent, Error(usage) when the raster is no
///         picture, Error(output) when Embree fails.
Frame ray_trace(const Scene& scene, const View& view, const Surface& surface, const Raster& raster,
                const RayTraceOptions& options);

} // namespace domewarp
