// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/image.h"

namespace domewarp {

/// What a frame holds beside its colours.
enum class Layers {
  colours, ///< nothing
  parity,  ///< ids, positions and depths: what `compare` needs
  all,     ///< linear light, normals and texture coordinates too
};

/// What a renderer saw in every pixel. All vectors hold height rows of width pixels, first row on top; they are empty
/// where the layer was not asked for. Everything but the colours is that of the ray or fragment at the pixel's centre,
/// however many samples the colours were made of.
struct Frame {
  int width = 0, height = 0;
  std::string renderer;   ///< the program and driver that made it
  int subpixel_bits = -1; ///< the rasteriser rounds vertices to 2^-this px; -1 for rays, which are exact
  std::vector<std::uint8_t> rgba;    ///< 4 per pixel, sRGB with straight alpha
  std::vector<Vec3f> position;       ///< source position in eye space; NaN where nothing was hit or none is known
  std::vector<float> depth;          ///< |position|, NaN likewise
  std::vector<float> drawn_depth;    ///< rasterised frames: how far in front of the camera, which is what decided; NaN likewise
  std::vector<std::uint32_t> object; ///< instance index + 1, 0 where nothing was hit
  std::vector<std::uint32_t>
      triangle;              ///< index of the triangle in its instance + 1 (all primitives counted), 0 likewise
  std::vector<Vec4f> light;  ///< linear red, green, blue multiplied by alpha, and alpha; over the background
  std::vector<Vec3f> normal; ///< unit, in eye space, on the side that is seen; NaN where nothing was hit
  std::vector<Vec2f> uv;     ///< of the base colour texture, as it is looked up; NaN likewise
  std::vector<std::uint16_t> rays;   ///< rays that were traced for the pixel, when they were to be counted
  std::vector<std::string> warnings; ///< one sentence each: images that are missing or broken and drawn white
};

/// Takes a picture in pieces: whole rows, from row `top` of the picture down, in order. Called by one thread.
using FrameSink = std::function<void(const Frame& rows, int top)>;

/// A frame in which nothing was hit, black and transparent.
/// @throws Error(usage) when a size is not positive or the picture has more than 2^28 pixels.
Frame make_frame(int width, int height, Layers layers = Layers::parity);

/// Leaves nothing hit, black and transparent, where the pixel's centre is farther than `radius` (image units) from the axis.
void clear_beyond(Frame& frame, double radius);

/// The colours alone.
Pixels colours(const Frame& frame);

/// Where the time went: white where one ray was traced, black where the most were. @param most at least 2
Pixels hot_spot_picture(const Frame& frame, std::uint16_t most);

} // namespace domewarp
