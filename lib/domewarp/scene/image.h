// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace domewarp {

/// A picture in memory: height rows of width pixels, first row on top, 4 bytes each: sRGB red, green, blue and straight
/// (not premultiplied) alpha.
struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

/// The most pixels `decode_image` unpacks, whatever a file claims: 1 GiB of RGBA.
inline constexpr std::uint64_t max_image_pixels = std::uint64_t{1} << 28;

/// Unpacks a PNG, JPEG or WebP; the bytes decide which, not a name or a MIME type. Deeper channels are rounded to 8
/// bits. A JPEG or PNG with damage its decoder can repair (a cut JPEG, extra bytes) is read as far as it goes.
/// @param name what messages call the image
/// @throws Error(input) naming the image when it is none of the three, broken, or larger than max_image_pixels (checked
///         before anything of that size is allocated).
Pixels decode_image(std::span<const std::uint8_t> bytes, const std::string& name);

/// Packs 8-bit sRGB samples as PNG. The same samples give the same bytes.
/// @param channels 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA (straight alpha)
/// @param samples  height rows of width x channels, first row on top
/// @throws Error(output) when a size is not positive, the samples are not as many as the sizes say, or memory runs out.
std::vector<std::uint8_t> encode_png(int width, int height, int channels, std::span<const std::uint8_t> samples);

} // namespace domewarp
