// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/frame.h"

#include <limits>

#include "domewarp/core/errors.h"

namespace domewarp {

Frame make_frame(int width, int height) {
  if (width < 1 || height < 1 || std::uint64_t(width) * std::uint64_t(height) > max_image_pixels)
    throw Error(ErrorCode::usage, "--size " + std::to_string(width) + "x" + std::to_string(height) +
                                      ": needs positive sizes and at most 2^28 pixels");
  const std::size_t count = std::size_t(width) * std::size_t(height);
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  Frame frame;
  frame.width = width;
  frame.height = height;
  frame.rgba.assign(4 * count, 0);
  frame.position.assign(count, Vec3f(none));
  frame.depth.assign(count, none);
  frame.object.assign(count, 0);
  frame.triangle.assign(count, 0);
  return frame;
}

Pixels colours(const Frame& frame) {
  return {frame.width, frame.height, frame.rgba};
}

} // namespace domewarp
