// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/image.h"

namespace domewarp {

/// What a renderer saw in every pixel. All vectors hold height rows of width pixels, first row on top.
struct Frame {
  int width = 0, height = 0;
  std::string renderer;              ///< the program and driver that made it
  std::vector<std::uint8_t> rgba;    ///< 4 per pixel, sRGB with straight alpha
  std::vector<Vec3f> position;       ///< source position in eye space; NaN where nothing was hit or none is known
  std::vector<float> depth;          ///< |position|, NaN likewise
  std::vector<std::uint32_t> object; ///< instance index + 1, 0 where nothing was hit
  std::vector<std::uint32_t>
      triangle;                      ///< index of the triangle in its instance + 1 (all primitives counted), 0 likewise
  std::vector<std::string> warnings; ///< one sentence each: images that are missing or broken and drawn white
};

/// A frame in which nothing was hit, black and transparent.
/// @throws Error(usage) when a size is not positive or the picture has more than 2^28 pixels.
Frame make_frame(int width, int height);

/// The colours alone.
Pixels colours(const Frame& frame);

} // namespace domewarp
