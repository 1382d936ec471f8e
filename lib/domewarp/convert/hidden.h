// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "domewarp/profile/surface.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"

namespace domewarp {

/// How far rays at twice the picture's density see, for asking what is hidden from all of them. Blended surfaces, holes of
/// masked ones, and back faces that are not drawn hide nothing; neither do lines and points.
class SeenDepths {
public:
  /// Traces 4 rays per pixel and keeps one float for each pixel and a third more.
  /// @throws Error as ray_trace does
  SeenDepths(const Scene& scene, const View& view, const Surface& surface, const Raster& raster);

  /// Whether every ray within `margin` of the box from `low` to `high` (image units) ends nearer to the eye than
  /// `nearest` (scene units). A box of which nothing is in the picture is not hidden.
  bool is_hidden(const Vec2& low, const Vec2& high, double margin, double nearest) const;

private:
  struct Level {
    int width = 0, height = 0;
    std::vector<float> farthest; ///< of the rays in each cell; infinite where one of them hits nothing
  };
  float farthest_within(int left, int top, int right, int bottom) const;

  Raster raster_;
  std::vector<Level> levels_; ///< cells of 1, 2, 4, ... pixels
};

} // namespace domewarp
