// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/image_format.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace domewarp::gltf {

using namespace std::string_view_literals;

namespace {

struct Format {
  std::string_view mime, extension, magic;
  std::size_t offset;
};

constexpr std::array<Format, 6> formats = {{{"image/png", "png", "\x89PNG\r\n\x1a\n"sv, 0},
                                            {"image/jpeg", "jpg", "\xff\xd8\xff"sv, 0},
                                            {"image/webp", "webp", "WEBPVP8"sv, 8},
                                            {"image/ktx2", "ktx2", "\xabKTX 20\xbb\r\n\x1a\n"sv, 0},
                                            {"image/avif", "avif", "ftypavif"sv, 4},
                                            {"image/vnd-ms.dds", "dds", "DDS "sv, 0}}};

std::size_t big_endian(std::span<const std::uint8_t> bytes, std::size_t offset, std::size_t count) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = (value << 8) | bytes[offset + i];
  return value;
}

std::string_view text(std::span<const std::uint8_t> bytes, std::size_t offset, std::size_t count) {
  return {reinterpret_cast<const char*>(bytes.data()) + offset, count};
}

std::string png_defect(std::span<const std::uint8_t> bytes) {
  bool has_data = false;
  for (std::size_t offset = 8; bytes.size() - offset >= 12;) {
    const std::size_t length = big_endian(bytes, offset, 4);
    const std::string_view type = text(bytes, offset + 4, 4);
    if (offset == 8 && (type != "IHDR" || length != 13)) return "its PNG has no header";
    if (length > bytes.size() - offset - 12) return "its PNG ends inside a chunk";
    if (offset == 8 && (big_endian(bytes, 16, 4) == 0 || big_endian(bytes, 20, 4) == 0)) return "its PNG has no pixels";
    has_data |= type == "IDAT";
    if (type == "IEND") return has_data ? "" : "its PNG has no pixels";
    offset += length + 12;
  }
  return "its PNG ends before its last chunk";
}

/// Start, arithmetic-coded and progressive frames included; DHT, JPG and DAC share the range.
bool is_frame(std::uint8_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

std::string jpeg_defect(std::span<const std::uint8_t> bytes) {
  for (std::size_t offset = 2; offset + 4 <= bytes.size();) {
    if (bytes[offset] != 0xFF) return "its JPEG has no marker where one should be";
    const std::uint8_t marker = bytes[offset + 1];
    if (marker == 0xFF) {
      ++offset;
      continue;
    }
    const std::size_t length = big_endian(bytes, offset + 2, 2);
    if (length < 2 || length > bytes.size() - offset - 2) return "its JPEG ends inside a segment";
    if (is_frame(marker)) {
      const bool has_size = length >= 8 && big_endian(bytes, offset + 5, 2) > 0 && big_endian(bytes, offset + 7, 2) > 0;
      return has_size ? "" : "its JPEG has no pixels";
    }
    offset += 2 + length;
  }
  return "its JPEG ends before its frame";
}

std::string webp_defect(std::span<const std::uint8_t> bytes) {
  std::size_t size = 0;
  for (std::size_t i = 4; i-- > 0;) size = (size << 8) | bytes[4 + i];
  if (text(bytes, 0, 4) != "RIFF") return "its WebP has no header";
  return size + 8 > bytes.size() ? "its WebP is truncated" : "";
}

} // namespace

std::string sniff_mime(std::span<const std::uint8_t> bytes) {
  for (const Format& format : formats)
    if (bytes.size() >= format.offset + format.magic.size() &&
        text(bytes, format.offset, format.magic.size()) == format.magic)
      return std::string(format.mime);
  return {};
}

std::string image_defect(std::span<const std::uint8_t> bytes, const std::string& mime) {
  if (mime == "image/png") return png_defect(bytes);
  if (mime == "image/jpeg") return jpeg_defect(bytes);
  if (mime == "image/webp") return webp_defect(bytes);
  return {};
}

namespace {

double jpeg_pixels(std::span<const std::uint8_t> bytes) {
  for (std::size_t offset = 2; offset + 9 <= bytes.size() && bytes[offset] == 0xFF;) {
    if (is_frame(bytes[offset + 1])) return static_cast<double>(big_endian(bytes, offset + 5, 2)) * static_cast<double>(big_endian(bytes, offset + 7, 2));
    offset += bytes[offset + 1] == 0xFF ? 1 : 2 + big_endian(bytes, offset + 2, 2);
  }
  return 0;
}

/// The three kinds of WebP keep their size at different places, little end first.
double webp_pixels(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 30) return 0;
  const auto word = [&](std::size_t offset, std::size_t count) {
    std::size_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = (value << 8) | bytes[offset + i];
    return value;
  };
  const auto product = [](std::size_t width, std::size_t height) { return static_cast<double>(width) * static_cast<double>(height); };
  const std::string_view kind = text(bytes, 12, 4);
  if (kind == "VP8X") return product(word(24, 3) + 1, word(27, 3) + 1);
  if (kind == "VP8L") return product((word(21, 4) & 0x3FFF) + 1, (word(21, 4) >> 14 & 0x3FFF) + 1);
  return kind == "VP8 " ? product(word(26, 2) & 0x3FFF, word(28, 2) & 0x3FFF) : 0;
}

} // namespace

double image_pixels(std::span<const std::uint8_t> bytes) {
  const std::string mime = sniff_mime(bytes);
  if (mime == "image/png") return bytes.size() < 24 ? 0 : static_cast<double>(big_endian(bytes, 16, 4)) * static_cast<double>(big_endian(bytes, 20, 4));
  if (mime == "image/jpeg") return jpeg_pixels(bytes);
  return mime == "image/webp" ? webp_pixels(bytes) : 0;
}

std::string file_extension(const std::string& mime) {
  const auto found =
      std::find_if(formats.begin(), formats.end(), [&](const Format& format) { return format.mime == mime; });
  return found == formats.end() ? "bin" : std::string(found->extension);
}

} // namespace domewarp::gltf
