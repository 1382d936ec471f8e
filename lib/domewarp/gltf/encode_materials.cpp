// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string_view>

#include <glm/common.hpp>
#include <nlohmann/json.hpp>

#include "domewarp/gltf/encode.h"
#include "domewarp/gltf/materials.h"
#include "domewarp/gltf/uri.h"

namespace domewarp::gltf {

using json = nlohmann::ordered_json;

namespace {

/// Mean nothing, or refer to something that is not written, in a material or texture.
constexpr std::array<std::string_view, 10> foreign = {
    "KHR_mesh_quantization",   "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing", "KHR_lights_punctual",        "KHR_node_visibility",     "KHR_materials_variants",
    "KHR_xmp_json_ld",         "KHR_animation_pointer"};

void drop_foreign(json& object) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return;
  for (const std::string_view name : foreign) extensions->erase(std::string(name));
  if (extensions->empty()) object.erase("extensions");
}

json list_of(const Vec4& v) {
  return {v.x, v.y, v.z, v.w};
}
json list_of(const Vec3& v) {
  return {v.x, v.y, v.z};
}
json list_of(const Vec2& v) {
  return {v.x, v.y};
}

json texture_info(const TextureReference& reference) {
  json info = {{"index", reference.texture}};
  if (reference.texcoord > 0) info["texCoord"] = reference.texcoord;
  const bool moved = reference.offset != Vec2(0) || reference.scale != Vec2(1) || reference.rotation != 0;
  if (moved)
    info["extensions"]["KHR_texture_transform"] = {
        {"offset", list_of(reference.offset)}, {"rotation", reference.rotation}, {"scale", list_of(reference.scale)}};
  return info;
}

/// A material that did not come from a file.
json describe(const Material& material) {
  json result = json::object();
  if (!material.name.empty()) result["name"] = material.name;
  json& metallic = result["pbrMetallicRoughness"] = json::object();
  metallic["baseColorFactor"] = list_of(glm::clamp(material.base_color, Vec4(0), Vec4(1)));
  if (material.base_texture.texture >= 0) metallic["baseColorTexture"] = texture_info(material.base_texture);
  metallic["metallicFactor"] = std::clamp(material.metallic, 0.0, 1.0);
  metallic["roughnessFactor"] = std::clamp(material.roughness, 0.0, 1.0);
  const double brightest = std::max({material.emissive.x, material.emissive.y, material.emissive.z});
  if (brightest > 0)
    result["emissiveFactor"] = list_of(glm::max(material.emissive / std::max(brightest, 1.0), Vec3(0)));
  if (brightest > 1) result["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = brightest;
  if (material.emissive_texture.texture >= 0) result["emissiveTexture"] = texture_info(material.emissive_texture);
  if (material.alpha_mode != AlphaMode::opaque)
    result["alphaMode"] = material.alpha_mode == AlphaMode::mask ? "MASK" : "BLEND";
  if (material.alpha_mode == AlphaMode::mask) result["alphaCutoff"] = material.alpha_cutoff;
  if (material.double_sided) result["doubleSided"] = true;
  return result;
}

/// The extension that a texture needs to draw an image of this type; empty for PNG and JPEG.
std::string_view extension_for(std::string_view mime) {
  if (mime == "image/webp") return "EXT_texture_webp";
  if (mime == "image/avif") return "EXT_texture_avif";
  if (mime == "image/ktx2") return "KHR_texture_basisu";
  if (mime == "image/vnd-ms.dds") return "MSFT_texture_dds";
  return {};
}

json describe(const Texture& texture) {
  json result = json::object();
  if (texture.sampler >= 0) result["sampler"] = texture.sampler;
  if (texture.image >= 0) result["source"] = texture.image;
  return result;
}

json describe(const Sampler& sampler) {
  const auto one_of = [](int value, std::initializer_list<int> values) {
    return std::find(values.begin(), values.end(), value) != values.end();
  };
  json result = json::object();
  if (one_of(sampler.mag_filter, {9728, 9729})) result["magFilter"] = sampler.mag_filter;
  if (one_of(sampler.min_filter, {9728, 9729, 9984, 9985, 9986, 9987})) result["minFilter"] = sampler.min_filter;
  if (one_of(sampler.wrap_s, {33071, 33648})) result["wrapS"] = sampler.wrap_s;
  if (one_of(sampler.wrap_t, {33071, 33648})) result["wrapT"] = sampler.wrap_t;
  return result;
}

bool has_index(const json& value) {
  return value.is_object() && value.contains("index") && value["index"].is_number_integer();
}

} // namespace

int MaterialWriter::use(int material) {
  return material < 0 ? -1 : materials_.number(material);
}

int MaterialWriter::texcoords(int index) {
  if (index < 0) return 0;
  const auto [known, is_new] = texcoords_.try_emplace(index, 0);
  if (!is_new) return known->second;
  const Material& material = scene_.materials[static_cast<std::size_t>(index)];
  const std::set<int> sets = texcoord_sets(material.json.empty() ? describe(material).dump() : material.json);
  return known->second = sets.empty() ? 0 : *sets.rbegin() + 1;
}

/// Replaces or, when nothing is left to draw, removes the texture references below `object`.
void MaterialWriter::remap_textures(json& object) {
  if (!object.is_object()) return;
  std::vector<std::string> lost;
  for (auto& [key, value] : object.items()) {
    if (key == "extras") continue;
    if (has_index(value)) {
      const int texture = use_texture(value["index"].get<int>());
      if (texture < 0) lost.push_back(key);
      value["index"] = texture;
    }
    remap_textures(value);
  }
  for (const std::string& key : lost) object.erase(key);
}

json MaterialWriter::material_json(const Material& material) {
  json result = material.json.empty() ? describe(material) : json::parse(material.json);
  drop_foreign(result);
  if (material.unlit && !(result.contains("extensions") && result["extensions"].contains("KHR_materials_unlit")))
    result["extensions"]["KHR_materials_unlit"] = json::object();
  remap_textures(result);
  return result;
}

/// Whether any image of a texture has bytes.
bool MaterialWriter::is_drawable(int index) {
  const auto [known, is_new] = drawable_.try_emplace(index, false);
  if (!is_new) return known->second;
  const Texture& texture = scene_.textures[static_cast<std::size_t>(index)];
  const json source = texture.json.empty() ? describe(texture) : json::parse(texture.json);
  const auto has_bytes = [&](const json& object) {
    if (!object.is_object() || !object.contains("source")) return false;
    const auto image = object["source"].get<std::size_t>();
    return image < scene_.images.size() && !scene_.images[image].bytes.empty();
  };
  bool drawable = has_bytes(source);
  if (source.contains("extensions") && source["extensions"].is_object())
    for (const auto& [name, object] : source["extensions"].items()) drawable = drawable || has_bytes(object);
  return known->second = drawable;
}

/// -1 for what cannot be drawn.
int MaterialWriter::use_texture(int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= scene_.textures.size() || !is_drawable(index)) return -1;
  return textures_.number(index);
}

int MaterialWriter::use_image(int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= scene_.images.size() ||
      scene_.images[static_cast<std::size_t>(index)].bytes.empty())
    return -1;
  return images_.number(index);
}

int MaterialWriter::use_sampler(int sampler) {
  return sampler < 0 || static_cast<std::size_t>(sampler) >= scene_.samplers.size() ? -1 : samplers_.number(sampler);
}

json MaterialWriter::texture_json(const Texture& texture) {
  json result = texture.json.empty() ? describe(texture) : json::parse(texture.json);
  drop_foreign(result);
  if (result.contains("sampler")) {
    result["sampler"] = use_sampler(result["sampler"].get<int>());
    if (result["sampler"] == -1) result.erase("sampler");
  }
  move_source(result);
  std::vector<std::string> lost;
  if (result.contains("extensions"))
    for (auto& [name, object] : result["extensions"].items()) {
      if (!object.is_object() || !object.contains("source")) continue;
      object["source"] = use_image(object["source"].get<int>());
      if (object["source"] == -1) lost.push_back(name);
    }
  for (const std::string& name : lost) result["extensions"].erase(name);
  if (result.contains("extensions") && result["extensions"].empty()) result.erase("extensions");
  return result;
}

/// Plain sources can be PNG and JPEG only. Some exporters put WebP there; the picture stays when it moves.
void MaterialWriter::move_source(json& texture) {
  if (!texture.contains("source")) return;
  const int source = texture["source"].get<int>();
  const int image = use_image(source);
  const std::string_view extension =
      image < 0 ? std::string_view() : extension_for(scene_.images[static_cast<std::size_t>(source)].mime);
  texture["source"] = image;
  if (!extension.empty() && !(texture.contains("extensions") && texture["extensions"].contains(extension)))
    texture["extensions"][std::string(extension)]["source"] = source;
  if (image < 0 || !extension.empty()) texture.erase("source");
}

json MaterialWriter::image_json(int index) {
  const Image& image = scene_.images[static_cast<std::size_t>(index)];
  json result = json::object();
  if (!image.name.empty()) result["name"] = image.name;
  if (!image.extras.empty()) result["extras"] = json::parse(image.extras);
  if (placement_.image_path) {
    const std::string path = placement_.image_path(static_cast<std::size_t>(index));
    result["uri"] = percent_encode(path);
    files_.push_back({path, &image.bytes});
  } else {
    result["mimeType"] = image.mime;
    result["bufferView"] = layout_.add_view(image.bytes);
  }
  return result;
}

void MaterialWriter::finish(json& root) {
  // Materials find textures, textures find images and samplers.
  for (const int i : materials_.items())
    root["materials"].push_back(material_json(scene_.materials[static_cast<std::size_t>(i)]));
  for (const int i : textures_.items())
    root["textures"].push_back(texture_json(scene_.textures[static_cast<std::size_t>(i)]));
  for (const int i : images_.items()) root["images"].push_back(image_json(i));
  for (const int i : samplers_.items()) {
    const Sampler& sampler = scene_.samplers[static_cast<std::size_t>(i)];
    json& written = root["samplers"].emplace_back(describe(sampler));
    if (!sampler.extras.empty()) written["extras"] = json::parse(sampler.extras);
  }
}

} // namespace domewarp::gltf
