// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "domewarp/core/progress.h"
#include "domewarp/profile/surface.h"
#include "domewarp/render/frame.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"

namespace domewarp {

struct RayTraceOptions {
  double near = 0;                                       ///< nothing is hit nearer to the eye than this
  bool unlit = false;                                    ///< colours without any shading, as with `convert --unlit`
  bool lights = false;                                   ///< the scene's own lights instead of one at the eye
  bool shadows = false;                                  ///< cast by opaque and masked surfaces in those lights
  double exposure = 0;                                   ///< of those lights, stops
  std::array<std::uint8_t, 4> background = {0, 0, 0, 0}; ///< sRGB, straight alpha
  Layers layers = Layers::parity;
  int samples = 1;         ///< in pixels that need more than one, 1 to 4096
  double contrast = 0.03;  ///< of lightness (0..1) or alpha within 3 x 3 pixels, above which a pixel needs them
  bool outlines = true;    ///< pixels crossed by an outline that may be visible need them too; false is the thesis
  bool count_rays = false; ///< fill Frame::rays
  std::string embree;      ///< Embree's device configuration, "isa=sse4.2" for instance; the picture is the same
  Progress progress;       ///< stages "trace" and "sample"
};

/// The reference: the picture of a scene on the surface, from the original geometry. A pixel shows the direction that
/// Surface::direction gives for its radius, so every branch of a multi-valued curve is drawn; beyond r_max there is
/// background. One ray goes through every pixel's centre. Where that is not enough, the pixel is the mean of `samples`
/// rays, spread over it by an Owen-scrambled Sobol sequence. Positions and depths are computed in double precision;
/// among equally near triangles the smallest (object, triangle) is seen. Back faces of single-sided materials, masked
/// texels and blended fragments of no visible alpha do not count as hits. Blended surfaces are composed front to back,
/// at most 128 of them; position, ids and depth are those of the nearest one. Points and lines have no area and are
/// left out. The same frame comes out on any CPU and with any number of threads. Shading: see shading.h.
/// @throws Error(input) when the scene is inconsistent or has no lights to use, Error(usage) when the raster is no
///         picture or `samples` is out of range, Error(output) when Embree fails.
Frame ray_trace(const Scene& scene, const View& view, const Surface& surface, const Raster& raster,
                const RayTraceOptions& options);

/// The same picture of any size in bands, of which one is held at a time (and one byte for every pixel of the picture,
/// with more than one sample).
void ray_trace(const Scene& scene, const View& view, const Surface& surface, const Raster& raster,
               const RayTraceOptions& options, const FrameSink& sink);

} // namespace domewarp
