// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "domewarp/render/frame.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

struct RasterOptions {
  bool unlit = false;                                    ///< colours without any shading
  std::array<std::uint8_t, 4> background = {0, 0, 0, 0}; ///< sRGB, straight alpha
  int tile = 2048; ///< pixels across the largest piece drawn at once (the driver may allow less)
};

/// Draws the triangles of any scene through the first camera in it with OpenGL, headless. The camera's vertical
/// extent fills the picture's height; pixels are square. Positions and depths come from the attribute _SOURCE_POSITION
/// (NaN for primitives without it). Blended triangles are drawn after the others, farthest first; ids and positions are
/// those of the nearest fragment that is not invisible. Depth is float32, 1 at the near plane, with room of 1e-6 beyond
/// both. Shading: see shading.h.
/// @throws Error(input) when there is no camera or one that shows nothing, or the scene is inconsistent;
///         Error(usage) when the raster is no picture; Error(output) when no OpenGL 4.5 device answers or the scene
///         does not fit into it.
Frame rasterise(const Scene& scene, const Raster& raster, const RasterOptions& options);

} // namespace domewarp
