// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/materials.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

using nlohmann::json;

namespace {

/// Files use a handful of sets; each one below the largest costs the writer an entry per primitive.
constexpr double largest_texcoord = 31;

const json* member(const json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() ? &*found : nullptr;
}

const json* extension(const json& object, const char* name) {
  const json* all = member(object, "extensions");
  return all ? member(*all, name) : nullptr;
}

double number(const json& object, const char* key, double otherwise) {
  const json* value = member(object, key);
  return value && value->is_number() ? value->get<double>() : otherwise;
}

template <typename Vec>
void read_vector(const json& object, const char* key, Vec& vector) {
  const json* value = member(object, key);
  if (!value || !value->is_array() || value->size() < static_cast<std::size_t>(Vec::length())) return;
  for (int i = 0; i < Vec::length(); ++i)
    if (const json& item = (*value)[static_cast<std::size_t>(i)]; item.is_number()) vector[i] = item.get<double>();
}

TextureReference read_reference(const json& object, const char* key) {
  TextureReference reference;
  const json* info = member(object, key);
  if (!info) return reference;
  reference.texture = info->at("index").get<int>();
  reference.texcoord = static_cast<int>(std::min(number(*info, "texCoord", 0), largest_texcoord));
  const json* transform = extension(*info, "KHR_texture_transform");
  if (!transform) return reference;
  read_vector(*transform, "offset", reference.offset);
  read_vector(*transform, "scale", reference.scale);
  reference.rotation = number(*transform, "rotation", 0);
  reference.texcoord = static_cast<int>(std::clamp(number(*transform, "texCoord", reference.texcoord), 0.0, largest_texcoord));
  return reference;
}

AlphaMode alpha_mode(const std::string& text) {
  return text == "MASK" ? AlphaMode::mask : text == "BLEND" ? AlphaMode::blend : AlphaMode::opaque;
}

/// Factors out of range would make every file invalid that carries them on.
void clamp_factor(json& value, double high, const std::string& place, std::vector<std::string>& warnings) {
  if (value.is_array()) {
    for (json& item : value) clamp_factor(item, high, place, warnings);
  } else if (const double number = value.get<double>(); !(number >= 0 && number <= high)) {
    warnings.push_back(place + ": is " + value.dump() + ", which is out of range and clamped");
    value = std::clamp(number, 0.0, high);
  }
}

void clamp_factors(json& material, const std::string& place, std::vector<std::string>& warnings) {
  for (const char* key : {"baseColorFactor", "metallicFactor", "roughnessFactor"})
    if (const auto metallic = material.find("pbrMetallicRoughness");
        metallic != material.end() && metallic->contains(key))
      clamp_factor((*metallic)[key], 1, place + "." + key, warnings);
  if (material.contains("emissiveFactor"))
    clamp_factor(material["emissiveFactor"], 1, place + ".emissiveFactor", warnings);
  if (material.contains("alphaCutoff")) clamp_factor(material["alphaCutoff"], 1e30, place + ".alphaCutoff", warnings);
  const std::string mode = material.value("alphaMode", "OPAQUE");
  if (mode == "OPAQUE" || mode == "MASK" || mode == "BLEND") return;
  warnings.push_back(place + ".alphaMode: is the unknown \"" + mode.substr(0, 60) + "\" and taken for OPAQUE");
  material.erase("alphaMode");
}

Material read_material(json source, const std::string& place, std::vector<std::string>& warnings) {
  clamp_factors(source, place, warnings);
  Material material;
  material.name = source.value("name", "");
  if (const json* metallic = member(source, "pbrMetallicRoughness")) {
    read_vector(*metallic, "baseColorFactor", material.base_color);
    material.base_texture = read_reference(*metallic, "baseColorTexture");
    material.metallic = number(*metallic, "metallicFactor", 1);
    material.roughness = number(*metallic, "roughnessFactor", 1);
  }
  if (const json* glossy = extension(source, "KHR_materials_pbrSpecularGlossiness")) {
    read_vector(*glossy, "diffuseFactor", material.base_color);
    material.base_texture = read_reference(*glossy, "diffuseTexture");
    material.metallic = 0;
    material.roughness = 1 - number(*glossy, "glossinessFactor", 1);
  }
  read_vector(source, "emissiveFactor", material.emissive);
  if (const json* strength = extension(source, "KHR_materials_emissive_strength"))
    material.emissive *= number(*strength, "emissiveStrength", 1);
  material.emissive_texture = read_reference(source, "emissiveTexture");
  material.alpha_mode = alpha_mode(source.value("alphaMode", "OPAQUE"));
  material.alpha_cutoff = number(source, "alphaCutoff", 0.5);
  material.double_sided = source.value("doubleSided", false);
  material.unlit = extension(source, "KHR_materials_unlit") != nullptr;
  material.json = source.dump();
  return material;
}

Texture read_texture(const json& source) {
  Texture texture;
  texture.image = source.value("source", -1);
  texture.sampler = source.value("sampler", -1);
  if (const json* webp = extension(source, "EXT_texture_webp")) texture.image = webp->value("source", texture.image);
  texture.json = source.dump();
  return texture;
}

} // namespace

namespace {

void collect_texcoords(const json& object, std::set<int>& sets) {
  if (!object.is_object()) return;
  for (const auto& [key, value] : object.items()) {
    if (key == "extras") continue;
    if (key.size() > 7 && key.ends_with("Texture")) sets.insert(read_reference(object, key.c_str()).texcoord);
    collect_texcoords(value, sets);
  }
}

} // namespace

std::set<int> texcoord_sets(const std::string& material_json) {
  std::set<int> sets;
  if (!material_json.empty()) collect_texcoords(json::parse(material_json), sets);
  return sets;
}

void read_materials(const json& root, Scene& scene) {
  if (const json* materials = member(root, "materials"))
    for (const json& material : *materials)
      scene.materials.push_back(read_material(material, at("materials", scene.materials.size()), scene.warnings));
  if (const json* textures = member(root, "textures"))
    for (const json& texture : *textures) scene.textures.push_back(read_texture(texture));
}

} // namespace domewarp::gltf
