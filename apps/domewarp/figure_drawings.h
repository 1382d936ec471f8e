// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/profile/surface.h"
#include "domewarp/scene/image.h"
#include "domewarp/scene/raster.h"

namespace domewarp {

/// One picture of the thesis, ours.
struct Figure {
  std::string name;    ///< number and letter, "21a"
  std::string caption; ///< a few words
  Pixels pixels;
};

/// A part of a picture.
struct Crop {
  double left = 0, top = 0, width = 1, height = 1; ///< shares of the picture
};

/// That part, every pixel a square, about as large as the picture.
Pixels enlarge(const Pixels& pixels, const Crop& crop);

/// The picture with a red frame around that part.
Pixels mark(const Pixels& pixels, const Crop& crop);

/// The cross-section of a display: the curve, red where the picture shows it, view rays, and the picture's plane. Forward
/// is up. @param segments two pieces of the curve of equal length with their images, as in Figure 11
Pixels cross_section(const SurfaceOptions& options, const Raster& shape, const Raster& raster, bool segments = false);

/// All figures on one sheet with their names and captions. @param columns of `width` pixels each
Pixels contact_sheet(const std::vector<Figure>& figures, int columns, int width);

} // namespace domewarp
