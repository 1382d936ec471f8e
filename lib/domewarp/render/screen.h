// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/render/frame.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

/// A corner of a drawn triangle as a rasteriser sees it.
struct ScreenCorner {
  Vec2 pixel;                ///< columns to the right and rows down from the picture's top left corner
  double weight = 1;         ///< 1 / w: attributes times this are linear on the screen
  Vec3 source = Vec3(0);     ///< _SOURCE_POSITION
};

struct ScreenTriangle {
  ScreenCorner corners[3];
  std::uint32_t object = 0;   ///< instance index + 1
  std::uint32_t triangle = 0; ///< in its instance, all primitives counted
  bool opaque = true;         ///< its material draws every fragment
};

/// What rasterise() draws of a scene, through its first camera; triangles that reach behind the eye are left out.
struct Screen {
  std::vector<ScreenTriangle> triangles; ///< by object and triangle
  std::vector<std::size_t> first;        ///< by object - 1: its first entry in `triangles`; one more at the end
  bool has_source = false;               ///< every primitive says where it came from
  bool perspective = true;               ///< its camera
};

/// @throws Error(input) when there is no camera
Screen make_screen(const Scene& scene, const Raster& raster);

/// The triangle with these numbers, or null.
const ScreenTriangle* find_triangle(const Screen& screen, std::uint32_t object, std::uint32_t triangle);

/// How often the surface that a frame shows at a pixel covers its centre: the triangles of the same object whose source
/// position there is as far away as the frame's (relative to `depth_bound`). 1 where all is well, 0 where the frame shows
/// nothing. Covers as OpenGL does: corners on the frame's subpixel grid (1/256 pixel
/// when it names none), top-left rule. Only opaque materials count, and only triangles
/// that have an area in the scene.
/// @param frame of the same scene, with source positions
std::vector<std::uint8_t> count_covers(const Screen& screen, const Frame& frame, double depth_bound);

} // namespace domewarp
