// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/frame.h"

#include <algorithm>
#include <limits>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/scene/raster.h"

namespace domewarp {

Frame make_frame(int width, int height, Layers layers) {
  if (width < 1 || height < 1 || std::uint64_t(width) * std::uint64_t(height) > max_image_pixels)
    throw Error(ErrorCode::usage, "--size " + std::to_string(width) + "x" + std::to_string(height) +
                                      ": needs positive sizes and at most 2^28 pixels held at once");
  const std::size_t count = std::size_t(width) * std::size_t(height);
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  Frame frame;
  frame.width = width;
  frame.height = height;
  frame.rgba.assign(4 * count, 0);
  if (layers == Layers::colours) return frame;
  frame.position.assign(count, Vec3f(none));
  frame.depth.assign(count, none);
  frame.object.assign(count, 0);
  frame.triangle.assign(count, 0);
  if (layers == Layers::parity) return frame;
  frame.light.assign(count, Vec4f(0));
  frame.normal.assign(count, Vec3f(none));
  frame.uv.assign(count, Vec2f(none));
  return frame;
}

void clear_beyond(Frame& frame, double radius) {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const Raster raster{frame.width, frame.height};
  for (int row = 0; row < frame.height; ++row)
    for (int column = 0; column < frame.width; ++column) {
      if (glm::length(pixel_centre(raster, column, row)) <= radius) continue;
      const std::size_t i = std::size_t(row) * std::size_t(frame.width) + std::size_t(column);
      std::fill_n(frame.rgba.begin() + static_cast<std::ptrdiff_t>(4 * i), 4, std::uint8_t{0});
      if (!frame.object.empty()) frame.object[i] = frame.triangle[i] = 0;
      if (!frame.position.empty()) frame.position[i] = Vec3f(none);
      if (!frame.normal.empty()) frame.normal[i] = Vec3f(none);
      for (std::vector<float>* depth : {&frame.depth, &frame.drawn_depth})
        if (!depth->empty()) (*depth)[i] = none;
    }
}

Pixels colours(const Frame& frame) {
  return {frame.width, frame.height, frame.rgba};
}

Pixels hot_spot_picture(const Frame& frame, std::uint16_t most) {
  Pixels picture{frame.width, frame.height, {}};
  picture.rgba.reserve(4 * frame.rays.size());
  for (const int rays : frame.rays) {
    const int level = 255 - 255 * std::clamp(rays - 1, 0, most - 1) / (most - 1);
    picture.rgba.insert(picture.rgba.end(), 3, static_cast<std::uint8_t>(level));
    picture.rgba.push_back(255);
  }
  return picture;
}

} // namespace domewarp
