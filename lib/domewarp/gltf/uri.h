// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace domewarp::gltf {

struct DataUri {
  std::string mime;
  std::vector<std::uint8_t> bytes;
};

bool is_data_uri(std::string_view uri);

/// The content of a data: URI, or nothing when it is not valid base64 or percent-encoded text.
std::optional<DataUri> decode_data_uri(std::string_view uri);

/// Replaces %XX; nothing when a % is not followed by two hexadecimal digits or yields a NUL.
std::optional<std::string> percent_decode(std::string_view text);

/// The other way: everything but letters, digits and -._~/ becomes %XX.
std::string percent_encode(std::string_view text);

/// True for a decoded relative path without scheme, root, backslash, control character or "..".
bool stays_inside(std::string_view path);

/// The file a URI names, relative to `folder`.
/// @throws Error(input) when it has a scheme, or leaves the folder (also through symbolic links) and `allow_external`
/// is false. The file need not exist.
std::filesystem::path resolve_uri(const std::filesystem::path& folder, const std::string& uri, bool allow_external);

} // namespace domewarp::gltf
