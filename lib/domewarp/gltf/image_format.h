// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace domewarp::gltf {

/// The media type that the first bytes tell, empty when they tell none.
std::string sniff_mime(std::span<const std::uint8_t> bytes);

/// What is wrong with the frame of an image (chunks, markers, sizes), empty when nothing is. Pixels are not decoded.
std::string image_defect(std::span<const std::uint8_t> bytes, const std::string& mime);

/// Width times height of a PNG, JPEG or WebP, by its first bytes; 0 when they do not tell.
double image_pixels(std::span<const std::uint8_t> bytes);

/// "png" for image/png and so on, "bin" for unknown types.
std::string file_extension(const std::string& mime);

} // namespace domewarp::gltf
