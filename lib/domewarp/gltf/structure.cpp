// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/structure.h"

#include <cmath>
#include <cstdint>
#include <span>

#include <nlohmann/json.hpp>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

using nlohmann::json;

namespace {

/// Where we are, spelled out only when something is wrong.
struct Place {
  const Place* parent = nullptr;
  const char* key = "";
  std::size_t index = 0;
  bool is_item = false;

  std::string text() const {
    std::string name = parent ? parent->text() : std::string();
    if (is_item) return name + "[" + std::to_string(index) + "]";
    return name.empty() ? key : name + "." + key;
  }
};

enum class Kind { text, flag, number, natural, index, indices, numbers, object };

struct Rule {
  const char* key;
  Kind kind;
  bool required = false;
  const char* target = ""; ///< the root list that an index refers to
  std::size_t size = 0;    ///< of `numbers`, 0 for any
};

constexpr double largest_natural = 9007199254740992.0; // 2^53: exact in a double

bool is_natural(const json& value) {
  if (value.is_number_integer()) return value.is_number_unsigned() || value.get<std::int64_t>() >= 0;
  // Exporters written in languages without integers spell 3 as 3.0.
  return value.is_number_float() && value.get<double>() >= 0 && value.get<double>() <= largest_natural &&
         std::floor(value.get<double>()) == value.get<double>();
}

std::string shown(const json& value) {
  return value.dump().substr(0, 60);
}

class Checker {
 public:
  Checker(const json& root, std::vector<std::string>& warnings) : root_(root), warnings_(warnings) {}

  void check(const json& object, const Place& place, std::span<const Rule> rules) {
    if (!object.is_object()) refuse(place.text(), "must be an object, not " + shown(object));
    for (const Rule& rule : rules) {
      const auto found = object.find(rule.key);
      const Place here{&place, rule.key};
      if (found != object.end())
        check_value(*found, here, rule);
      else if (rule.required)
        refuse(here.text(), "is missing");
    }
  }

  /// Calls body(item, place) for each object of a list that may be absent.
  template <typename Body>
  void each(const json& object, const Place* parent, const char* key, Body&& body) {
    const auto found = object.find(key);
    if (found == object.end()) return;
    const Place list{parent, key};
    if (!found->is_array()) refuse(list.text(), "must be a list, not " + shown(*found));
    if (found->empty()) warnings_.push_back(list.text() + ": is an empty list");
    std::size_t index = 0;
    for (const json& item : *found) body(item, Place{&list, "", index++, true});
  }

  void each(const char* key, std::span<const Rule> rules) {
    each(root_, nullptr, key, [&](const json& item, const Place& place) { check(item, place, rules); });
  }

  void check_index(const json& value, const Place& place, const char* target) {
    if (!is_natural(value)) refuse(place.text(), "must be an index, not " + shown(value));
    const auto list = root_.find(target);
    const std::size_t count = list != root_.end() && list->is_array() ? list->size() : 0;
    if (value.get<double>() >= static_cast<double>(count))
      refuse(place.text(), "refers to " + std::string(target) + "[" + shown(value) + "], of which the file has " +
                               std::to_string(count));
  }

  /// An object that maps names to accessors.
  void check_attributes(const json& object, const Place& place) {
    if (!object.is_object()) refuse(place.text(), "must be an object, not " + shown(object));
    for (const auto& [key, value] : object.items()) check_index(value, Place{&place, key.c_str()}, "accessors");
  }

  void warn(std::string warning) { warnings_.push_back(std::move(warning)); }

 private:
  void check_value(const json& value, const Place& place, const Rule& rule) {
    const auto expect = [&](bool good, const char* kind) {
      if (!good) refuse(place.text(), std::string("must be ") + kind + ", not " + shown(value));
    };
    switch (rule.kind) {
    case Kind::text:
      return expect(value.is_string(), "a text");
    case Kind::flag:
      return expect(value.is_boolean(), "true or false");
    case Kind::number:
      return expect(value.is_number(), "a number");
    case Kind::natural:
      return expect(is_natural(value) && value.get<double>() <= largest_natural, "a whole number below 2^53");
    case Kind::object:
      return expect(value.is_object(), "an object");
    case Kind::index:
      return check_index(value, place, rule.target);
    case Kind::indices:
      return check_indices(value, place, rule.target);
    case Kind::numbers:
      return check_numbers(value, place, rule.size);
    }
  }

  void check_indices(const json& value, const Place& place, const char* target) {
    if (!value.is_array()) refuse(place.text(), "must be a list, not " + shown(value));
    if (value.empty()) warnings_.push_back(place.text() + ": is an empty list");
    std::size_t index = 0;
    for (const json& item : value) check_index(item, Place{&place, "", index++, true}, target);
  }

  void check_numbers(const json& value, const Place& place, std::size_t size) {
    bool good = value.is_array() && (size == 0 || value.size() == size);
    if (good)
      for (const json& item : value) good = good && item.is_number();
    if (!good)
      refuse(place.text(),
             "must be a list of " + (size ? std::to_string(size) + " " : "") + "numbers, not " + shown(value));
  }

  const json& root_;
  std::vector<std::string>& warnings_;
};

constexpr Rule asset_rules[] = {{"version", Kind::text, true}, {"minVersion", Kind::text}, {"copyright", Kind::text}};
constexpr Rule buffer_rules[] = {{"byteLength", Kind::natural, true}, {"uri", Kind::text}};
constexpr Rule view_rules[] = {{"buffer", Kind::index, true, "buffers"},
                               {"byteOffset", Kind::natural},
                               {"byteLength", Kind::natural, true},
                               {"byteStride", Kind::natural}};
constexpr Rule meshopt_rules[] = {{"buffer", Kind::index, true, "buffers"},
                                  {"byteOffset", Kind::natural},
                                  {"byteLength", Kind::natural, true},
                                  {"byteStride", Kind::natural, true},
                                  {"count", Kind::natural, true},
                                  {"mode", Kind::text, true},
                                  {"filter", Kind::text}};
constexpr Rule accessor_rules[] = {{"bufferView", Kind::index, false, "bufferViews"},
                                   {"byteOffset", Kind::natural},
                                   {"componentType", Kind::natural, true},
                                   {"normalized", Kind::flag},
                                   {"count", Kind::natural, true},
                                   {"type", Kind::text, true},
                                   {"min", Kind::numbers},
                                   {"max", Kind::numbers},
                                   {"sparse", Kind::object}};
constexpr Rule sparse_rules[] = {
    {"count", Kind::natural, true}, {"indices", Kind::object, true}, {"values", Kind::object, true}};
constexpr Rule sparse_index_rules[] = {{"bufferView", Kind::index, true, "bufferViews"},
                                       {"byteOffset", Kind::natural},
                                       {"componentType", Kind::natural, true}};
constexpr Rule sparse_value_rules[] = {{"bufferView", Kind::index, true, "bufferViews"}, {"byteOffset", Kind::natural}};
constexpr Rule primitive_rules[] = {{"attributes", Kind::object, true},
                                    {"indices", Kind::index, false, "accessors"},
                                    {"material", Kind::index, false, "materials"},
                                    {"mode", Kind::natural}};
constexpr Rule draco_rules[] = {{"bufferView", Kind::index, true, "bufferViews"}, {"attributes", Kind::object, true}};
constexpr Rule mesh_rules[] = {{"name", Kind::text}, {"weights", Kind::numbers}};
constexpr Rule node_rules[] = {{"name", Kind::text},
                               {"camera", Kind::index, false, "cameras"},
                               {"mesh", Kind::index, false, "meshes"},
                               {"skin", Kind::index, false, "skins"},
                               {"children", Kind::indices, false, "nodes"},
                               {"matrix", Kind::numbers, false, "", 16},
                               {"rotation", Kind::numbers, false, "", 4},
                               {"scale", Kind::numbers, false, "", 3},
                               {"translation", Kind::numbers, false, "", 3},
                               {"weights", Kind::numbers}};
constexpr Rule skin_rules[] = {{"joints", Kind::indices, true, "nodes"},
                               {"inverseBindMatrices", Kind::index, false, "accessors"},
                               {"skeleton", Kind::index, false, "nodes"}};
constexpr Rule scene_rules[] = {{"name", Kind::text}, {"nodes", Kind::indices, false, "nodes"}};
constexpr Rule camera_rules[] = {{"name", Kind::text}, {"type", Kind::text, true}};
constexpr Rule perspective_rules[] = {
    {"yfov", Kind::number, true}, {"znear", Kind::number, true}, {"zfar", Kind::number}, {"aspectRatio", Kind::number}};
constexpr Rule orthographic_rules[] = {{"xmag", Kind::number, true},
                                       {"ymag", Kind::number, true},
                                       {"znear", Kind::number, true},
                                       {"zfar", Kind::number, true}};
constexpr Rule image_rules[] = {{"name", Kind::text},
                                {"uri", Kind::text},
                                {"mimeType", Kind::text},
                                {"bufferView", Kind::index, false, "bufferViews"}};
constexpr Rule source_rules[] = {{"source", Kind::index, false, "images"}};
constexpr Rule texture_rules[] = {{"sampler", Kind::index, false, "samplers"},
                                  {"source", Kind::index, false, "images"}};
constexpr Rule sampler_rules[] = {
    {"wrapS", Kind::natural}, {"wrapT", Kind::natural}, {"magFilter", Kind::natural}, {"minFilter", Kind::natural}};
constexpr Rule material_rules[] = {
    {"name", Kind::text},      {"pbrMetallicRoughness", Kind::object}, {"emissiveFactor", Kind::numbers, false, "", 3},
    {"alphaMode", Kind::text}, {"alphaCutoff", Kind::number},          {"doubleSided", Kind::flag}};
constexpr Rule metallic_rules[] = {{"baseColorFactor", Kind::numbers, false, "", 4},
                                   {"metallicFactor", Kind::number},
                                   {"roughnessFactor", Kind::number}};
constexpr Rule texture_info_rules[] = {{"index", Kind::index, true, "textures"}, {"texCoord", Kind::natural}};
constexpr Rule light_rules[] = {
    {"name", Kind::text},        {"type", Kind::text, true}, {"color", Kind::numbers, false, "", 3},
    {"intensity", Kind::number}, {"range", Kind::number},    {"spot", Kind::object}};
constexpr Rule spot_rules[] = {{"innerConeAngle", Kind::number}, {"outerConeAngle", Kind::number}};
constexpr Rule animation_rules[] = {{"name", Kind::text}};
constexpr Rule animation_sampler_rules[] = {{"input", Kind::index, true, "accessors"},
                                            {"output", Kind::index, true, "accessors"},
                                            {"interpolation", Kind::text}};
constexpr Rule channel_rules[] = {{"sampler", Kind::natural, true}, {"target", Kind::object, true}};
constexpr Rule target_rules[] = {{"node", Kind::index, false, "nodes"}, {"path", Kind::text, true}};

const json* extension(const json& object, const char* name) {
  const auto all = object.find("extensions");
  if (all == object.end() || !all->is_object()) return nullptr;
  const auto found = all->find(name);
  return found == all->end() ? nullptr : &*found;
}

void check_views(Checker& checker, const json& root) {
  checker.each("buffers", buffer_rules);
  checker.each(root, nullptr, "bufferViews", [&](const json& view, const Place& place) {
    checker.check(view, place, view_rules);
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
      if (const json* meshopt = extension(view, name)) checker.check(*meshopt, Place{&place, name}, meshopt_rules);
  });
  checker.each(root, nullptr, "accessors", [&](const json& accessor, const Place& place) {
    checker.check(accessor, place, accessor_rules);
    const auto sparse = accessor.find("sparse");
    if (sparse == accessor.end()) return;
    const Place here{&place, "sparse"};
    checker.check(*sparse, here, sparse_rules);
    if (sparse->at("count").get<double>() > INT32_MAX) // what tinygltf holds
      refuse(here.text(), "replaces " + sparse->at("count").dump() + " elements, too many");
    checker.check(sparse->at("indices"), Place{&here, "indices"}, sparse_index_rules);
    checker.check(sparse->at("values"), Place{&here, "values"}, sparse_value_rules);
  });
}

void check_primitive(Checker& checker, const json& primitive, const Place& place) {
  checker.check(primitive, place, primitive_rules);
  checker.check_attributes(primitive.at("attributes"), Place{&place, "attributes"});
  checker.each(primitive, &place, "targets",
               [&](const json& target, const Place& here) { checker.check_attributes(target, here); });
  const json* draco = extension(primitive, "KHR_draco_mesh_compression");
  if (!draco) return;
  const Place here{&place, "KHR_draco_mesh_compression"};
  checker.check(*draco, here, draco_rules);
  for (const auto& [key, id] : draco->at("attributes").items())
    if (!is_natural(id) || id.get<double>() > 2147483647)
      refuse(here.text() + "." + key, "must be an index, not " + shown(id));
}

void check_meshes(Checker& checker, const json& root) {
  checker.each(root, nullptr, "meshes", [&](const json& mesh, const Place& place) {
    checker.check(mesh, place, mesh_rules);
    if (!mesh.contains("primitives")) refuse(place.text() + ".primitives", "is missing");
    checker.each(mesh, &place, "primitives",
                 [&](const json& primitive, const Place& here) { check_primitive(checker, primitive, here); });
  });
}

void check_cameras(Checker& checker, const json& root) {
  checker.each(root, nullptr, "cameras", [&](const json& camera, const Place& place) {
    checker.check(camera, place, camera_rules);
    const std::string type = camera.at("type");
    if (type != "perspective" && type != "orthographic")
      refuse(place.text() + ".type", "is \"" + type + "\", which is no kind of camera");
    if (!camera.contains(type)) refuse(place.text() + "." + type, "is missing");
    const bool perspective = type == "perspective";
    if (camera.contains(perspective ? "orthographic" : "perspective"))
      checker.warn(place.text() + ": has the factors of both kinds; those of \"" + type + "\" are taken");
    if (perspective)
      checker.check(camera.at(type), Place{&place, "perspective"}, perspective_rules);
    else
      checker.check(camera.at(type), Place{&place, "orthographic"}, orthographic_rules);
  });
}

bool names_texture(const std::string& key) {
  return key.ends_with("Texture") && key.size() > 7;
}

/// Texture references stand in the material itself and in its extensions, at any depth.
void check_texture_infos(Checker& checker, const json& object, const Place& place) {
  if (!object.is_object()) return;
  for (const auto& [key, value] : object.items()) {
    const Place here{&place, key.c_str()};
    if (key == "extras") continue;
    if (names_texture(key)) {
      checker.check(value, here, texture_info_rules);
      if (value.value("texCoord", 0.0) > 31)
        refuse(here.text() + ".texCoord", "is " + value.at("texCoord").dump() + "; 31 is the largest that can be read");
    }
    check_texture_infos(checker, value, here);
  }
}

void check_materials(Checker& checker, const json& root) {
  checker.each(root, nullptr, "materials", [&](const json& material, const Place& place) {
    checker.check(material, place, material_rules);
    const auto metallic = material.find("pbrMetallicRoughness");
    if (metallic != material.end()) checker.check(*metallic, Place{&place, "pbrMetallicRoughness"}, metallic_rules);
    check_texture_infos(checker, material, place);
  });
  checker.each("images", image_rules);
  checker.each("samplers", sampler_rules);
  checker.each(root, nullptr, "textures", [&](const json& texture, const Place& place) {
    checker.check(texture, place, texture_rules);
    const auto extensions = texture.find("extensions");
    if (extensions == texture.end() || !extensions->is_object()) return;
    for (const auto& [name, object] : extensions->items())
      checker.check(object, Place{&place, name.c_str()}, source_rules);
  });
}

void check_lights(Checker& checker, const json& root) {
  const json* lights = extension(root, "KHR_lights_punctual");
  if (!lights) return;
  const Place place{nullptr, "KHR_lights_punctual"};
  if (!lights->is_object() || !lights->contains("lights")) refuse("KHR_lights_punctual.lights", "is missing");
  checker.each(*lights, &place, "lights", [&](const json& light, const Place& here) {
    checker.check(light, here, light_rules);
    if (light.at("type") == "spot" && !light.contains("spot")) refuse(here.text() + ".spot", "is missing");
    if (light.contains("spot")) checker.check(light.at("spot"), Place{&here, "spot"}, spot_rules);
  });
}

void check_nodes(Checker& checker, const json& root) {
  checker.each(root, nullptr, "nodes", [&](const json& node, const Place& place) {
    checker.check(node, place, node_rules);
    if (node.contains("matrix") &&
        (node.contains("translation") || node.contains("rotation") || node.contains("scale")))
      checker.warn(place.text() + ": has a matrix and translation, rotation or scale; the matrix is taken");
    const json* instancing = extension(node, "EXT_mesh_gpu_instancing");
    if (!instancing) return;
    if (!instancing->is_object() || !instancing->contains("attributes"))
      refuse(place.text() + ".EXT_mesh_gpu_instancing.attributes", "is missing");
    checker.check_attributes(instancing->at("attributes"), Place{&place, "EXT_mesh_gpu_instancing"});
  });
  checker.each("skins", skin_rules);
  checker.each("scenes", scene_rules);
  if (root.contains("scene")) checker.check_index(root.at("scene"), Place{nullptr, "scene"}, "scenes");
}

void check_animations(Checker& checker, const json& root) {
  checker.each(root, nullptr, "animations", [&](const json& animation, const Place& place) {
    checker.check(animation, place, animation_rules);
    std::size_t samplers = 0;
    checker.each(animation, &place, "samplers", [&](const json& sampler, const Place& here) {
      checker.check(sampler, here, animation_sampler_rules);
      ++samplers;
    });
    checker.each(animation, &place, "channels", [&](const json& channel, const Place& here) {
      checker.check(channel, here, channel_rules);
      checker.check(channel.at("target"), Place{&here, "target"}, target_rules);
      if (channel.at("sampler").get<double>() >= static_cast<double>(samplers))
        refuse(here.text() + ".sampler", "refers to samplers[" + shown(channel.at("sampler")) +
                                             "], of which there are " + std::to_string(samplers));
    });
  });
}

} // namespace

void check_structure(const json& root, std::vector<std::string>& warnings) {
  if (!root.is_object()) refuse("JSON", "must be an object, not " + shown(root));
  Checker checker(root, warnings);
  if (!root.contains("asset")) refuse("asset", "is missing");
  checker.check(root.at("asset"), Place{nullptr, "asset"}, asset_rules);
  check_views(checker, root);
  check_meshes(checker, root);
  check_nodes(checker, root);
  check_cameras(checker, root);
  check_materials(checker, root);
  check_lights(checker, root);
  check_animations(checker, root);
}

} // namespace domewarp::gltf
