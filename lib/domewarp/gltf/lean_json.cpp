// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/lean_json.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>

#include <nlohmann/json.hpp>

namespace domewarp::gltf {

using nlohmann::json;

namespace {

using Keys = std::initializer_list<const char*>;

/// A copy without extras and extensions, and with 3.0 as 3 (tinygltf ignores an index that is spelled 3.0).
json plain(const json& value) {
  if (value.is_number_float()) {
    const double number = value.get<double>();
    const bool whole = std::abs(number) < 9e15 && std::floor(number) == number;
    return whole && number >= 0 ? json(static_cast<std::uint64_t>(number)) : value;
  }
  if (value.is_array()) {
    json copy = json::array();
    for (const json& item : value) copy.push_back(plain(item));
    return copy;
  }
  if (!value.is_object()) return value;
  json copy = json::object();
  for (const auto& [key, item] : value.items())
    if (key != "extras" && key != "extensions") copy[key] = plain(item);
  return copy;
}

json select(const json& object, Keys keys) {
  json copy = json::object();
  for (const char* key : keys)
    if (const auto found = object.find(key); found != object.end()) copy[key] = plain(*found);
  return copy;
}

void copy_list(const json& root, json& lean, const char* list, Keys keys) {
  if (!root.contains(list)) return;
  json& copies = lean[list] = json::array();
  for (const json& item : root.at(list)) copies.push_back(select(item, keys));
}

/// tinygltf refuses index accessors without a view, which Draco and all-zero indices have.
void drop_indices_without_view(json& lean) {
  if (!lean.contains("meshes")) return;
  for (json& mesh : lean["meshes"])
    for (json& primitive : mesh["primitives"])
      if (primitive.contains("indices") &&
          !lean["accessors"][primitive["indices"].get<std::size_t>()].contains("bufferView"))
        primitive.erase("indices");
}

void name_blobs(const json& root, json& lean, const std::vector<std::size_t>& buffer_sizes) {
  for (std::size_t i = 0; i < buffer_sizes.size(); ++i)
    lean["buffers"].push_back(
        {{"byteLength", std::max<std::size_t>(buffer_sizes[i], 1)}, {"uri", "buffer/" + std::to_string(i)}});
  if (!root.contains("images")) return;
  json& images = lean["images"];
  for (std::size_t i = 0; i < images.size(); ++i) images[i]["uri"] = "image/" + std::to_string(i);
}

} // namespace

json lean_json(const json& root, const std::vector<std::size_t>& buffer_sizes) {
  json lean = json::object();
  lean["asset"] = {{"version", "2.0"}};
  copy_list(root, lean, "bufferViews", {"buffer", "byteOffset", "byteLength", "byteStride"});
  copy_list(root, lean, "accessors",
            {"bufferView", "byteOffset", "componentType", "normalized", "count", "type", "min", "max", "sparse"});
  copy_list(root, lean, "meshes", {"name", "primitives", "weights"});
  copy_list(root, lean, "nodes",
            {"name", "camera", "mesh", "skin", "children", "matrix", "rotation", "scale", "translation", "weights"});
  copy_list(root, lean, "skins", {"joints", "inverseBindMatrices"});
  copy_list(root, lean, "scenes", {"name", "nodes"});
  copy_list(root, lean, "cameras", {"name", "type", "perspective", "orthographic"});
  copy_list(root, lean, "samplers", {"wrapS", "wrapT", "magFilter", "minFilter"});
  copy_list(root, lean, "images", {"name", "mimeType"});
  if (root.contains("scene")) lean["scene"] = plain(root.at("scene"));
  name_blobs(root, lean, buffer_sizes);
  drop_indices_without_view(lean);
  return lean;
}

} // namespace domewarp::gltf
