// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/extensions.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>

#include <nlohmann/json.hpp>

namespace domewarp::gltf {

using nlohmann::json;

namespace {

constexpr std::array<std::string_view, 8> understood = {
    "KHR_mesh_quantization",   "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing", "KHR_texture_transform",      "KHR_lights_punctual",     "KHR_node_visibility"};
/// Part of material and texture objects, which are kept as they are.
constexpr std::array<std::string_view, 4> carried = {"EXT_texture_webp", "EXT_texture_avif", "KHR_texture_basisu",
                                                     "MSFT_texture_dds"};
/// Say nothing about the picture of the scene at rest.
constexpr std::array<std::string_view, 4> ignorable = {"KHR_materials_variants", "KHR_animation_pointer",
                                                       "KHR_xmp_json_ld", "KHR_node_selectability"};
/// Where extensions that are checked may stand; the list is that of the parent object, "" is the root.
const std::map<std::string_view, std::set<std::string_view>> places = {
    {"KHR_lights_punctual", {"", "nodes"}},     {"KHR_node_visibility", {"nodes"}},
    {"EXT_mesh_gpu_instancing", {"nodes"}},     {"EXT_texture_webp", {"textures"}},
    {"KHR_draco_mesh_compression", {"meshes"}}, {"EXT_meshopt_compression", {"bufferViews", "buffers"}},
    {"KHR_materials_unlit", {"materials"}}};

template <std::size_t n>
bool contains(const std::array<std::string_view, n>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_material_extension(std::string_view name) {
  return name.starts_with("KHR_materials_") && name != "KHR_materials_variants";
}

bool is_supported(std::string_view name) {
  return contains(understood, name) || contains(carried, name) || contains(ignorable, name) ||
         is_material_extension(name);
}

/// Calls visit(name, object) for every extension object below `value`; extras are not searched.
template <typename Visit>
void each_extension(const json& value, Visit&& visit) {
  if (!value.is_structured()) return;
  for (const auto& [key, item] : value.items()) {
    if (value.is_object() && key == "extras") continue;
    if (value.is_object() && key == "extensions" && item.is_object())
      for (const auto& [name, object] : item.items()) visit(name, object);
    each_extension(item, visit);
  }
}

std::set<std::string> names_in(const json& root, const char* list) {
  std::set<std::string> names;
  const auto found = root.find(list);
  if (found == root.end()) return names;
  if (!found->is_array()) refuse(list, "must be a list");
  for (const json& name : *found) {
    if (!name.is_string()) refuse(list, "must be a list of names");
    names.insert(name.get<std::string>());
  }
  return names;
}

void check_places(const std::string& list, const std::set<std::string>& names, Scene& scene) {
  for (const std::string& name : names) {
    const auto allowed = places.find(name);
    if (allowed == places.end() || allowed->second.contains(list)) continue;
    scene.warnings.push_back(name + ": stands in " + (list.empty() ? "the root" : list) + ", where it means nothing");
  }
}

const json* extension(const json& object, const char* name) {
  const auto all = object.find("extensions");
  if (all == object.end() || !all->is_object()) return nullptr;
  const auto found = all->find(name);
  return found == all->end() ? nullptr : &*found;
}

std::size_t natural(const json& object, const char* key) {
  return object.contains(key) ? static_cast<std::size_t>(object.at(key).get<double>()) : 0;
}

AttributeMap attributes_of(const json& object) {
  AttributeMap attributes;
  for (const auto& [name, value] : object.at("attributes").items()) attributes.emplace_back(name, value.get<int>());
  return attributes;
}

void read_meshopt(const json& view, View& result) {
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (const json* source = extension(view, name))
      result.meshopt = {source->at("buffer").get<int>(), natural(*source, "byteOffset"), natural(*source, "byteLength"),
                        natural(*source, "byteStride"),  natural(*source, "count"),      source->at("mode"),
                        source->value("filter", "NONE")};
}

void read_primitive(const json& primitive, PrimitiveSource& result) {
  if (primitive.contains("indices")) result.indices = primitive.at("indices").get<int>();
  const json* draco = extension(primitive, "KHR_draco_mesh_compression");
  if (!draco) return;
  result.draco_view = draco->at("bufferView").get<int>();
  result.draco_attributes = attributes_of(*draco);
}

void read_node(const json& node, std::size_t index, NodeSource& result, Scene& scene) {
  if (const json* instancing = extension(node, "EXT_mesh_gpu_instancing"))
    result.instancing = attributes_of(*instancing);
  if (const json* visibility = extension(node, "KHR_node_visibility"))
    if (visibility->is_object() && visibility->contains("visible") && visibility->at("visible").is_boolean())
      result.visible = visibility->at("visible").get<bool>();
  const json* light = extension(node, "KHR_lights_punctual");
  if (!light) return;
  const std::string place = at("nodes", index) + ".KHR_lights_punctual";
  if (!light->is_object() || !light->contains("light") || !light->at("light").is_number())
    refuse(place + ".light", "is missing");
  const double number = light->at("light").get<double>();
  if (!(number >= 0) || number >= static_cast<double>(scene.lights.size()))
    refuse(place + ".light", "refers to lights[" + light->at("light").dump() + "], of which the file has " +
                                 std::to_string(scene.lights.size()));
  result.light = static_cast<int>(number);
}

} // namespace

void check_extensions(const json& root, Scene& scene) {
  const std::set<std::string> used = names_in(root, "extensionsUsed"), required = names_in(root, "extensionsRequired");
  for (const std::string& name : required)
    if (!is_supported(name)) refuse("extensionsRequired", "needs " + name + ", which is not supported");
  for (const std::string& name : required)
    if (!used.contains(name)) scene.warnings.push_back(name + ": is required but not in extensionsUsed");
  std::set<std::string> found, kept;
  for (const auto& [list, value] : root.items()) {
    std::set<std::string> here;
    const bool is_root = list == "extensions";
    if (is_root && value.is_object())
      for (const auto& [name, object] : value.items()) here.insert(name);
    each_extension(value, [&](const std::string& name, const json&) { here.insert(name); });
    check_places(is_root ? "" : list, here, scene);
    found.insert(here.begin(), here.end());
    if (list == "materials" || list == "textures") kept.insert(here.begin(), here.end());
  }
  for (const std::string& name : found)
    if (!used.contains(name)) scene.warnings.push_back(name + ": is used but not in extensionsUsed");
  for (const std::string& name : used)
    if (!contains(understood, name) && !contains(carried, name) && !kept.contains(name) && !is_material_extension(name))
      scene.dropped_extensions.push_back(name);
}

void read_extensions(const json& root, Document& document) {
  for (std::size_t i = 0; i < document.views.size(); ++i) read_meshopt(root.at("bufferViews")[i], document.views[i]);
  for (std::size_t i = 0; i < document.meshes.size(); ++i)
    for (std::size_t k = 0; k < document.meshes[i].primitives.size(); ++k)
      read_primitive(root.at("meshes")[i].at("primitives")[k], document.meshes[i].primitives[k]);
  for (std::size_t i = 0; i < document.nodes.size(); ++i)
    read_node(root.at("nodes")[i], i, document.nodes[i], document.scene);
}

bool is_required(const json& root, const std::string& extension) {
  return names_in(root, "extensionsRequired").contains(extension);
}

std::vector<Light> read_lights(const json& root, std::vector<std::string>& warnings) {
  std::vector<Light> lights;
  const json* punctual = extension(root, "KHR_lights_punctual");
  if (!punctual) return lights;
  for (const json& source : punctual->at("lights")) {
    Light& light = lights.emplace_back();
    const std::string type = source.at("type");
    light.name = source.value("name", "");
    light.kind = type == "directional" ? LightKind::directional : type == "spot" ? LightKind::spot : LightKind::point;
    if (source.contains("color"))
      for (int i = 0; i < 3; ++i) light.color[i] = source.at("color")[static_cast<std::size_t>(i)].get<double>();
    light.intensity = source.value("intensity", 1.0);
    light.range = source.value("range", 0.0);
    if (light.kind == LightKind::spot) {
      light.inner_cone = source.at("spot").value("innerConeAngle", 0.0);
      light.outer_cone = source.at("spot").value("outerConeAngle", light.outer_cone);
    }
    const bool known = type == "directional" || type == "spot" || type == "point";
    if (known) continue;
    warnings.push_back(at("lights", lights.size() - 1) + ": is of the unknown type \"" + type +
                       "\" and gives no light");
    light.intensity = 0;
  }
  return lights;
}

namespace {

Interpolation interpolation_of(const json& sampler) {
  const std::string name = sampler.value("interpolation", "LINEAR");
  return name == "CUBICSPLINE" ? Interpolation::cubic : name == "STEP" ? Interpolation::step : Interpolation::linear;
}

} // namespace

void read_animations(const json& root, Document& document) {
  if (!root.contains("animations")) return;
  std::size_t index = 0;
  for (const json& animation : root.at("animations")) {
    document.animations.push_back(animation.value("name", ""));
    if (animation.contains("channels"))
      for (const json& channel : animation.at("channels")) {
        const json& target = channel.at("target");
        const json& sampler = animation.at("samplers")[channel.at("sampler").get<std::size_t>()];
        document.animation_channels.push_back({index, target.value("node", -1), sampler.at("input").get<int>(),
                            sampler.at("output").get<int>(), target.at("path"),
                            interpolation_of(sampler)});
      }
    ++index;
  }
}

} // namespace domewarp::gltf
