// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "domewarp/profile/surface.h"
#include "domewarp/render/parts.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/view.h"

namespace domewarp {

/// The pixels that an outline of the scene passes through, visible or hidden: open edges, edges between a face that is
/// seen from the front and one that is not, edges between two materials. However small or thin an object is, its outline
/// is here, whether or not a ray through a pixel's centre meets it.
class Outlines {
 public:
  /// Walks every outline across the picture in steps of half a pixel.
  Outlines(const Parts& parts, const View& view, const Surface& surface, const Raster& raster);

  /// Whether an outline crosses this pixel that is not farther from the eye than `depth`.
  bool crosses(std::size_t pixel, double depth) const;

 private:
  std::vector<std::uint8_t> nearest_; ///< level of the nearest outline's distance, 255 for none
};

} // namespace domewarp
