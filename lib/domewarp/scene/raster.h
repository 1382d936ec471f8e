// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/core/vectors.h"

namespace domewarp {

/// The picture: y in [-1, 1], x in [-width/height, width/height], a pixel is 2/height units, pixel centres lie at
/// half-integers, the first row is on top.
struct Raster {
  int width = 4096;
  int height = 4096;
};

inline double aspect(const Raster& raster) { return static_cast<double>(raster.width) / raster.height; }
inline double pixel_size(const Raster& raster) { return 2.0 / raster.height; }

/// Image point of the centre of pixel (column, row) (erratum 2 of the thesis' Eq. 6 repaired).
inline Vec2 pixel_centre(const Raster& raster, double column, double row) {
  return {(column + 0.5 - 0.5 * raster.width) * pixel_size(raster), (0.5 * raster.height - row - 0.5) * pixel_size(raster)};
}

/// Radius of the circle through the corners of the picture.
double screen_radius(const Raster& raster);

} // namespace domewarp
