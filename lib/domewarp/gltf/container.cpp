// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/container.h"

#include <cstring>

namespace domewarp::gltf {

namespace {

constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
constexpr std::size_t deepest_nesting = 128;
/// Bytes of one parsed value in the two JSON trees and tinygltf's structs, measured on arrays of small numbers.
constexpr std::size_t bytes_per_value = 64;

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = (value << 8) | bytes[offset + i];
  return value;
}

std::size_t checked_length(std::span<const std::uint8_t> bytes, std::vector<std::string>& warnings) {
  if (bytes.size() < 12) refuse("GLB", "ends inside its header");
  const std::uint32_t version = word(bytes, 4), length = word(bytes, 8);
  if (version != 2) refuse("GLB", "has version " + std::to_string(version) + ", only glTF 2.0 can be read");
  if (length > bytes.size())
    refuse("GLB", "is truncated: its header says " + std::to_string(length) + " bytes, the file has " +
                      std::to_string(bytes.size()));
  if (length < 20) refuse("GLB", "has length " + std::to_string(length) + ", too short for a JSON chunk");
  if (length < bytes.size()) warnings.push_back("GLB: data after its end is ignored");
  return length;
}

void add_chunk(Container& container, std::uint32_t type, std::span<const std::uint8_t> data, std::size_t number) {
  if (number == 0 && type != json_chunk) refuse("GLB", "its first chunk is not JSON");
  if (number == 0 && data.empty()) refuse("GLB", "its JSON chunk is empty");
  if (number > 0 && type == json_chunk) refuse("GLB", "has two JSON chunks");
  if (type == binary_chunk && container.has_binary) refuse("GLB", "has two BIN chunks");
  if (type == binary_chunk && number != 1) refuse("GLB", "its BIN chunk is not the second one");
  if (type == json_chunk) container.json = {reinterpret_cast<const char*>(data.data()), data.size()};
  if (type == binary_chunk) {
    container.binary = data;
    container.has_binary = true;
  }
}

Container split_glb(std::span<const std::uint8_t> bytes, std::vector<std::string>& warnings) {
  const std::size_t length = checked_length(bytes, warnings);
  Container container;
  std::size_t offset = 12;
  for (std::size_t number = 0; offset < length; ++number) {
    if (length - offset < 8) refuse("GLB", "ends inside the header of a chunk");
    const std::size_t size = word(bytes, offset);
    if (size > length - offset - 8)
      refuse("GLB", "a chunk of " + std::to_string(size) + " bytes reaches beyond its end");
    if (size % 4 != 0)
      warnings.push_back("GLB: the length " + std::to_string(size) + " of a chunk is not a multiple of 4");
    add_chunk(container, word(bytes, offset + 4), bytes.subspan(offset + 8, size), number);
    offset += 8 + size;
  }
  return container;
}

} // namespace

Container split_container(std::span<const std::uint8_t> bytes, std::vector<std::string>& warnings) {
  if (bytes.empty()) refuse("file", "is empty");
  if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0) return split_glb(bytes, warnings);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t begin = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (begin == std::string_view::npos || (text[begin] != '{' && text[begin] != '['))
    refuse("file", "is neither a GLB nor JSON");
  return {text, {}, false};
}

void check_nesting(std::string_view json, Budget& budget) {
  std::size_t depth = 0, values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string && c == '\\')
      ++i;
    else if (c == '"')
      in_string = !in_string;
    else if (in_string)
      continue;
    else if (c == '[' || c == '{')
      ++depth, ++values;
    else if (c == ',')
      ++values;
    else if ((c == ']' || c == '}') && depth > 0)
      --depth;
    if (depth > deepest_nesting) refuse("JSON", "is nested deeper than " + std::to_string(deepest_nesting));
  }
  budget.charge(values, bytes_per_value, "JSON");
  budget.charge(json.size(), 3, "JSON");
}

} // namespace domewarp::gltf
