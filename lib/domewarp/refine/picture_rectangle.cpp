// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/picture_rectangle.h"

#include <algorithm>

namespace domewarp {

Vec2 kept_half_extent(const RefineOptions& options, const Raster& raster) {
  return Vec2(aspect(raster), 1) + (std::max({options.tolerance_px, options.texture_tolerance_px, options.plain_tolerance_px}) + 1) * pixel_size(raster);
}

bool is_beyond(std::span<const Vec2> points, const Vec2& half_extent) {
  for (int axis = 0; axis < 2; ++axis)
    for (const double side : {-1.0, 1.0})
      if (std::ranges::all_of(points, [&](const Vec2& p) { return side * p[axis] > half_extent[axis]; })) return true;
  return false;
}

} // namespace domewarp
