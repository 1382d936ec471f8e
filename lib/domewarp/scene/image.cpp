// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/image.h"

#include <algorithm>
#include <array>
#include <memory>

#include <png.h>
#include <turbojpeg.h>
#include <webp/decode.h>

#include "domewarp/core/errors.h"

namespace domewarp {

namespace {

using Bytes = std::span<const std::uint8_t>;

[[noreturn]] void refuse(const std::string& name, const std::string& reason) {
  throw Error(ErrorCode::input, "image " + name + ": " + reason);
}

/// Room for the pixels, once the size the file claims has been checked.
Pixels make_pixels(std::uint64_t width, std::uint64_t height, const std::string& name) {
  if (width == 0 || height == 0) refuse(name, "has no pixels");
  // Sizes come from 32-bit fields, so the product cannot overflow.
  if (width * height > max_image_pixels)
    refuse(name, "has " + std::to_string(width) + " x " + std::to_string(height) + " pixels, more than the limit of " +
                     std::to_string(max_image_pixels));
  Pixels pixels{static_cast<int>(width), static_cast<int>(height), {}};
  pixels.rgba.resize(width * height * 4);
  return pixels;
}

Pixels decode_png(Bytes bytes, const std::string& name) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const std::unique_ptr<png_image, decltype(&png_image_free)> guard(&image, png_image_free);
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) refuse(name, image.message);
  image.format = PNG_FORMAT_RGBA;
  Pixels pixels = make_pixels(image.width, image.height, name);
  if (!png_image_finish_read(&image, nullptr, pixels.rgba.data(), 0, nullptr)) refuse(name, image.message);
  return pixels;
}

Pixels decode_jpeg(Bytes bytes, const std::string& name) {
  const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
  if (!decoder) refuse(name, "no JPEG decoder could be made");
  int width = 0, height = 0, subsampling = 0, space = 0;
  if (tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &width, &height, &subsampling, &space) != 0)
    refuse(name, tjGetErrorStr2(decoder.get()));
  Pixels pixels = make_pixels(static_cast<std::uint64_t>(std::max(width, 0)),
                              static_cast<std::uint64_t>(std::max(height, 0)), name);
  // Without a limit on scans a small progressive file keeps the decoder busy for minutes.
  const int failed = tjDecompress2(decoder.get(), bytes.data(), bytes.size(), pixels.rgba.data(), width, 0, height,
                                   TJPF_RGBA, TJFLAG_LIMITSCANS | TJFLAG_ACCURATEDCT);
  if (failed && tjGetErrorCode(decoder.get()) != TJERR_WARNING) refuse(name, tjGetErrorStr2(decoder.get()));
  return pixels;
}

Pixels decode_webp(Bytes bytes, const std::string& name) {
  int width = 0, height = 0;
  if (!WebPGetInfo(bytes.data(), bytes.size(), &width, &height)) refuse(name, "is a WebP with a broken header");
  Pixels pixels = make_pixels(static_cast<std::uint64_t>(std::max(width, 0)),
                              static_cast<std::uint64_t>(std::max(height, 0)), name);
  if (!WebPDecodeRGBAInto(bytes.data(), bytes.size(), pixels.rgba.data(), pixels.rgba.size(), width * 4))
    refuse(name, "is a broken WebP");
  return pixels;
}

bool starts_with(Bytes bytes, std::size_t offset, const std::string& magic) {
  return bytes.size() >= offset + magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

} // namespace

Pixels decode_image(Bytes bytes, const std::string& name) {
  if (starts_with(bytes, 0, "\x89PNG\r\n\x1a\n")) return decode_png(bytes, name);
  if (starts_with(bytes, 0, "\xff\xd8\xff")) return decode_jpeg(bytes, name);
  if (starts_with(bytes, 0, "RIFF") && starts_with(bytes, 8, "WEBP")) return decode_webp(bytes, name);
  refuse(name, "is neither PNG, JPEG nor WebP");
}

std::vector<std::uint8_t> encode_png(int width, int height, int channels, Bytes samples) {
  constexpr std::array<png_uint_32, 4> formats = {PNG_FORMAT_GRAY, PNG_FORMAT_GA, PNG_FORMAT_RGB, PNG_FORMAT_RGBA};
  if (width < 1 || height < 1 || channels < 1 || channels > 4 ||
      samples.size() != std::size_t(width) * std::size_t(height) * std::size_t(channels))
    throw Error(ErrorCode::output, "PNG: " + std::to_string(samples.size()) + " samples do not make a picture of " +
                                       std::to_string(width) + " x " + std::to_string(height) + " pixels with " +
                                       std::to_string(channels) + " channels");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = formats[static_cast<std::size_t>(channels) - 1];
  // Packing once into the largest possible size is twice as quick as asking for the exact size first.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> bytes(size);
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, samples.data(), 0, nullptr))
    throw Error(ErrorCode::output, std::string("PNG: ") + image.message);
  bytes.resize(size);
  return bytes;
}

} // namespace domewarp
