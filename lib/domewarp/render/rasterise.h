// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "domewarp/core/progress.h"
#include "domewarp/render/frame.h"
#include "domewarp/render/lights.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

struct RasterOptions {
  bool unlit = false; ///< colours without any shading
  /// In the space of the source positions, camera space for primitives without them. Nothing: one light at the eye.
  std::optional<std::vector<PlacedLight>> lights;
  double exposure = 0;                                   ///< of those lights, stops
  std::array<std::uint8_t, 4> background = {0, 0, 0, 0}; ///< sRGB, straight alpha
  std::size_t camera = 0;                                ///< which of the scene's cameras to draw through
  Layers layers = Layers::parity;
  int supersample = 1; ///< colours are the mean of supersample^2 samples on a regular grid; 1 to 16
  int tile = 2048;     ///< pixels across the largest piece drawn at once
  Progress progress;   ///< stage "draw"
};

/// Draws any scene through a camera in it with OpenGL, headless. The camera's vertical extent fills the picture's
/// height; pixels are square. Positions and depths come from the attribute _SOURCE_POSITION (NaN for primitives without
/// it). Blended triangles are drawn after the others, farthest first; ids and positions are those of the nearest
/// fragment that is not invisible. Points and lines are one sample wide, unlit, and appear in the colours only. Depth is
/// float32, 1 at the near plane, with room of 1e-6 beyond both. Vertices are rounded to the driver's subpixel grid of
/// the whole picture and clipped by its borders alone, so that ids and coverage are the same for tiles of any size, up to
/// the largest viewport of the driver (16384 pixels or more); beyond that tiles are clipped one by one. What is interpolated
/// differs by rounding between tiles of different sizes; which tiles are drawn follows from `raster` and `options` only.
/// Shading: see shading.h, without shadows.
/// @throws Error(input) when there is no camera or one that shows nothing, or the scene is inconsistent;
///         Error(usage) when the raster is no picture or `supersample` is out of range; Error(output) when no OpenGL 4.5
///         device answers or the scene does not fit into it.
Frame rasterise(const Scene& scene, const Raster& raster, const RasterOptions& options);

/// The same picture, byte for byte, of any size in bands, of which one is held at a time.
void rasterise(const Scene& scene, const Raster& raster, const RasterOptions& options, const FrameSink& sink);

} // namespace domewarp
