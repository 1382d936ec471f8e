// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/extras.h"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace domewarp::gltf {

using nlohmann::json;

namespace {

const json* find(const json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() ? &*found : nullptr;
}

std::string extras_of(const json& object) {
  const json* extras = find(object, "extras");
  return extras == nullptr ? "" : extras->dump();
}

/// Calls take(index, item) for the items of a list of the file, of which there are `count`.
template <typename Take>
void each_item(const json& root, const char* list, std::size_t count, Take&& take) {
  const json* items = find(root, list);
  for (std::size_t i = 0; items != nullptr && i < std::min(count, items->size()); ++i) take(i, items->at(i));
}

std::string mesh_extras(const json& mesh) {
  const json* extras = find(mesh, "extras");
  if (extras == nullptr || !extras->is_object() || !extras->contains("targetNames")) return extras_of(mesh);
  json rest = *extras;
  rest.erase("targetNames");
  return rest.empty() ? "" : rest.dump();
}

void read_asset_extras(const json& asset, Scene& scene) {
  const json* extras = find(asset, "extras");
  if (extras == nullptr) return;
  if (!extras->is_object()) {
    scene.dropped_extras.push_back("asset");
    return;
  }
  json rest = *extras;
  rest.erase("domewarp");
  if (!rest.empty()) scene.asset_extras = rest.dump();
}

bool any_has_extras(const json& items) {
  for (const json& item : items)
    if (find(item, "extras") != nullptr) return true;
  return false;
}

} // namespace

void read_extras(const json& root, Document& document) {
  Scene& scene = document.scene;
  scene.root_extras = extras_of(root);
  read_asset_extras(root.at("asset"), scene);
  each_item(root, "scenes", document.scenes.size(), [&](std::size_t i, const json& item) { document.scenes[i].extras = extras_of(item); });
  each_item(root, "nodes", document.nodes.size(), [&](std::size_t i, const json& item) { document.nodes[i].extras = extras_of(item); });
  each_item(root, "images", scene.images.size(), [&](std::size_t i, const json& item) { scene.images[i].extras = extras_of(item); });
  each_item(root, "samplers", scene.samplers.size(), [&](std::size_t i, const json& item) { scene.samplers[i].extras = extras_of(item); });
  each_item(root, "meshes", document.meshes.size(), [&](std::size_t i, const json& mesh) {
    document.meshes[i].extras = mesh_extras(mesh);
    std::vector<PrimitiveSource>& primitives = document.meshes[i].primitives;
    each_item(mesh, "primitives", primitives.size(), [&](std::size_t k, const json& item) { primitives[k].extras = extras_of(item); });
  });
  for (const char* list : {"accessors", "animations", "buffers", "bufferViews", "cameras", "skins"})
    if (const json* items = find(root, list); items != nullptr && any_has_extras(*items)) scene.dropped_extras.push_back(list);
}

} // namespace domewarp::gltf
