// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// The two parts of a file. A .gltf has no `binary`.
struct Container {
  std::string_view json;
  std::span<const std::uint8_t> binary;
  bool has_binary = false;
};

/// Splits a GLB into its chunks; anything that does not begin with its magic is taken for JSON text.
/// @throws Error(input) for another version, a truncated file, and missing, misplaced or repeated chunks.
Container split_container(std::span<const std::uint8_t> bytes, std::vector<std::string>& warnings);

/// Looks at the text before it is parsed: nesting deeper than 128 is refused, and the memory that the parsed values
/// will take is charged.
void check_nesting(std::string_view json, Budget& budget);

} // namespace domewarp::gltf
