// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// Where the bytes of a document come from.
struct Source {
  std::filesystem::path folder;
  bool allow_external = false;
  std::span<const std::uint8_t> binary;
  bool has_binary = false;
};

/// What each buffer holds: its byteLength, or 0 for a placeholder (the fallback of a compressed buffer).
std::vector<std::size_t> buffer_sizes(const nlohmann::json& root, const Source& source,
                                      std::vector<std::string>& warnings);

/// The BIN chunk of a GLB is the first buffer, unless that has a URI.
bool is_binary_chunk(const nlohmann::json& root, std::size_t index, const Source& source);

/// Makes the bytes of a GLB the first byteLength of its BIN chunk, which they hold.
/// @throws Error(input) when there are fewer
void cut_binary_chunk(const nlohmann::json& root, const Source& source, std::vector<std::uint8_t>& file);

/// The first byteLength bytes of a buffer from a data URI or a file.
/// @throws Error(input) when there are fewer, or its URI is refused.
std::vector<std::uint8_t> load_buffer(const nlohmann::json& root, std::size_t index, const Source& source,
                                      Budget& budget);

/// The file behind an image's URI. Missing and undecodable data gives a warning and no bytes.
/// @throws Error(input) when its URI is refused.
std::vector<std::uint8_t> load_image(const nlohmann::json& root, std::size_t index, const Source& source,
                                     Budget& budget, std::vector<std::string>& warnings);

/// Names and spells out the images, takes those in views from there, and checks that their bytes look like an image.
/// Broken ones lose their bytes and give a warning.
void finish_images(const nlohmann::json& root, Document& document, Budget& budget);

/// Ranges of views, and of the compressed data behind them, against the sizes of the buffers; strides.
void check_views(Document& document, const std::vector<std::size_t>& sizes);

} // namespace domewarp::gltf
