// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "domewarp/scene/raster.h"

namespace domewarp {

/// Rows of a picture that are drawn and held at once: about 8 million pixels.
inline int band_height(const Raster& raster) {
  return std::clamp((1 << 23) / raster.width, 32, std::max(raster.height, 32));
}

} // namespace domewarp
