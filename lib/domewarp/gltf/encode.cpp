// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/encode.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/decompose.h"

namespace domewarp::gltf {

using json = nlohmann::ordered_json;

namespace {

template <typename Vec>
json list_of(const Vec& vector) {
  json list = json::array();
  for (int i = 0; i < Vec::length(); ++i) list.push_back(vector[i]);
  return list;
}

json list_of(const Mat4& matrix) {
  json list = json::array();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) list.push_back(matrix[column][row]);
  return list;
}

bool is_drawn(const Primitive& primitive) {
  return !primitive.positions.empty() && !primitive.indices.empty();
}

bool is_mirrored(const Mat4& world) {
  return glm::dot(glm::cross(Vec3(world[0]), Vec3(world[1])), Vec3(world[2])) < 0;
}

class SceneWriter {
 public:
  SceneWriter(const Scene& scene, const WriteOptions& options, const Placement& placement)
      : scene_(scene), placement_(placement), materials_(scene, placement, layout_, result_.images) {
    if (options.draco && options.quantize) throw Error(ErrorCode::usage, "--draco and --quantize exclude each other");
    if (options.draco && options.meshopt) throw Error(ErrorCode::usage, "--draco and --meshopt exclude each other");
    layout_.use_meshopt = options.meshopt;
    packing_ = options.draco ? Packing::draco : options.quantize ? Packing::quantized : Packing::plain;
    if (packing_ != Packing::plain) grid_ = position_grid(scene, options).value();
  }

  EncodedScene write() {
    if (packing_ == Packing::plain && !layout_.use_meshopt) layout_.bytes.reserve(plain_size());
    for (const Instance& instance : scene_.instances) add_instance(instance);
    for (const Camera& camera : scene_.cameras) add_camera(camera);
    for (const Light& light : scene_.lights) add_light(light);
    json root = json::object();
    root["asset"] = asset();
    root["extensionsUsed"] = json::array();
    root["extensionsRequired"] = json::array();
    add_scene(root);
    materials_.finish(root);
    finish_layout(root);
    finish_extensions(root);
    result_.json = root.dump();
    result_.binary = std::move(layout_.bytes);
    return std::move(result_);
  }

 private:
  /// About what the buffer will hold, an instance's mesh counted once.
  std::size_t plain_size() const {
    std::size_t size = 0;
    for (const Mesh& mesh : scene_.meshes)
      for (const Primitive& primitive : mesh.primitives) {
        size += primitive.positions.size() * sizeof(Vec3f) + primitive.indices.size() * sizeof(std::uint32_t);
        for (const Attribute& attribute : primitive.attributes) size += attribute.values.size() * sizeof(float);
      }
    return size;
  }

  static void add_extras(json& object, const std::string& extras) {
    if (!extras.empty()) object["extras"] = json::parse(extras);
  }

  json asset() const {
    json asset = {{"version", "2.0"}, {"generator", "domewarp " DOMEWARP_VERSION}};
    if (!scene_.copyright.empty()) asset["copyright"] = scene_.copyright;
    add_extras(asset, scene_.asset_extras);
    if (!scene_.extras.empty()) asset["extras"]["domewarp"] = json::parse(scene_.extras);
    return asset;
  }

  void add_scene(json& root) {
    root["scene"] = 0;
    json scene = json::object();
    if (!scene_.name.empty()) scene["name"] = scene_.name;
    if (!roots_.empty()) scene["nodes"] = roots_;
    add_extras(scene, scene_.scene_extras);
    add_extras(root, scene_.root_extras);
    root["scenes"] = json::array({scene});
    if (!nodes_.empty()) root["nodes"] = nodes_;
    if (!meshes_.empty()) root["meshes"] = meshes_;
    if (!cameras_.empty()) root["cameras"] = cameras_;
    if (!lights_.empty()) root["extensions"]["KHR_lights_punctual"]["lights"] = lights_;
  }

  /// A node for a world matrix; one that shears or flattens takes two, of which the inner one carries `content`.
  void add_node(const std::string& name, const Mat4& world, const json& content) {
    json node = json::object();
    if (!name.empty()) node["name"] = name;
    roots_.push_back(nodes_.size());
    if (is_diagonal(world)) {
      place(node, Vec3(world[3]), Vec3(world[0][0], world[1][1], world[2][2]));
    } else if (is_decomposable(world) && largest_of(world) <= largest_matrix) {
      node["matrix"] = list_of(world);
    } else {
      const Decomposition parts = decompose(world);
      const bool is_one = parts.inner == Vec4(0, 0, 0, 1);
      json& outer = is_one ? node : nodes_.emplace_back(json{{"children", {nodes_.size() + 1}}});
      place(outer, parts.translation, parts.scale);
      outer["rotation"] = list_of(parts.outer);
      if (!is_one) node["rotation"] = list_of(parts.inner);
    }
    node.update(content);
    nodes_.push_back(std::move(node));
  }

  static void place(json& node, const Vec3& translation, const Vec3& scale) {
    if (translation != Vec3(0)) node["translation"] = list_of(translation);
    if (scale != Vec3(1)) node["scale"] = list_of(scale);
  }

  /// The Khronos validator takes matrices apart in single precision and wants them back within 5e-5.
  static constexpr double largest_matrix = 10;

  static double largest_of(const Mat4& world) {
    double largest = 0;
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) largest = std::max(largest, std::abs(world[c][r]));
    return largest;
  }

  void add_instance(const Instance& instance) {
    const int mesh = use_mesh(instance.mesh, is_mirrored(instance.world));
    if (mesh < 0) return;
    Mat4 world = instance.world;
    if (packing_ == Packing::quantized)
      world = world * Mat4(Vec4(grid_step(grid_), 0, 0, 0), Vec4(0, grid_step(grid_), 0, 0),
                           Vec4(0, 0, grid_step(grid_), 0), Vec4(grid_.origin, 1));
    json content = {{"mesh", mesh}};
    add_extras(content, instance.extras);
    add_node(instance.name, world, std::move(content));
  }

  /// A reader reverses the winding below a node that mirrors, so it is written reversed. -1 for what draws nothing.
  int use_mesh(int index, bool mirrored) {
    const auto [known, is_new] = mesh_numbers_.try_emplace({index, mirrored}, -1);
    const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(index)];
    if (!is_new || std::none_of(mesh.primitives.begin(), mesh.primitives.end(), is_drawn)) return known->second;
    json written = json::object();
    if (!mesh.name.empty()) written["name"] = mesh.name;
    written["primitives"] = json::array();
    for (const Primitive& primitive : mesh.primitives)
      if (is_drawn(primitive)) written["primitives"].push_back(add_primitive(primitive, mirrored));
    add_extras(written, mesh.extras);
    known->second = static_cast<int>(meshes_.size());
    meshes_.push_back(std::move(written));
    return known->second;
  }

  json add_primitive(const Primitive& primitive, bool mirrored) {
    const WrittenPrimitive written =
        write_primitive(primitive, mirrored, materials_.texcoords(primitive.material), packing_, grid_, layout_);
    json result = json::object();
    for (const auto& [name, accessor] : written.attributes) result["attributes"][name] = accessor;
    if (written.indices >= 0) result["indices"] = written.indices;
    if (written.material >= 0) result["material"] = materials_.use(written.material);
    if (written.mode != 4) result["mode"] = written.mode;
    add_extras(result, primitive.extras);
    if (written.draco_view < 0) return result;
    uses_draco_ = true;
    json& draco = result["extensions"]["KHR_draco_mesh_compression"];
    draco["bufferView"] = written.draco_view;
    for (const auto& [name, id] : written.draco_attributes) draco["attributes"][name] = id;
    return result;
  }

  void add_camera(const Camera& camera) {
    json written = json::object();
    if (!camera.name.empty()) written["name"] = camera.name;
    written["type"] = camera.perspective ? "perspective" : "orthographic";
    json& factors = written[camera.perspective ? "perspective" : "orthographic"];
    if (camera.perspective) {
      if (camera.aspect > 0) factors["aspectRatio"] = camera.aspect;
      factors["yfov"] = camera.yfov;
      factors["znear"] = camera.znear;
      if (camera.zfar > 0) factors["zfar"] = camera.zfar;
    } else {
      factors = {{"xmag", camera.xmag}, {"ymag", camera.ymag}, {"zfar", camera.zfar}, {"znear", camera.znear}};
    }
    add_node(camera.name, camera.world, {{"camera", cameras_.size()}});
    cameras_.push_back(std::move(written));
  }

  void add_light(const Light& light) {
    json written = json::object();
    if (!light.name.empty()) written["name"] = light.name;
    written["color"] = list_of(glm::clamp(light.color, Vec3(0), Vec3(1)));
    written["intensity"] = std::max(light.intensity, 0.0);
    written["type"] = light.kind == LightKind::directional ? "directional"
                      : light.kind == LightKind::spot      ? "spot"
                                                           : "point";
    if (light.range > 0 && light.kind != LightKind::directional) written["range"] = light.range;
    if (light.kind == LightKind::spot) {
      const double outer = std::clamp(light.outer_cone, 1e-6, 1.5707963267948966);
      written["spot"] = {{"innerConeAngle", std::clamp(light.inner_cone, 0.0, outer * 0.999999)},
                         {"outerConeAngle", outer}};
    }
    add_node(light.name, light.world, {{"extensions", {{"KHR_lights_punctual", {{"light", lights_.size()}}}}}});
    lights_.push_back(std::move(written));
  }

  void finish_layout(json& root) {
    for (const WrittenAccessor& accessor : layout_.accessors) {
      json& written = root["accessors"].emplace_back(json::object());
      if (accessor.view >= 0) written["bufferView"] = accessor.view;
      written["componentType"] = accessor.component_type;
      if (accessor.normalized) written["normalized"] = true;
      written["count"] = accessor.count;
      written["type"] = accessor.type;
      if (!accessor.low.empty()) written["min"] = accessor.low;
      if (!accessor.high.empty()) written["max"] = accessor.high;
    }
    for (const WrittenView& view : layout_.views) root["bufferViews"].push_back(view_json(view));
    if (layout_.bytes.empty()) return;
    if (std::max(layout_.bytes.size(), layout_.fallback_bytes) > UINT32_MAX)
      throw Error(ErrorCode::output, "the geometry and images need more than the 4 GiB that a glTF buffer can hold");
    json buffer = json::object();
    if (!placement_.binary_uri.empty()) buffer["uri"] = placement_.binary_uri;
    buffer["byteLength"] = layout_.bytes.size();
    root["buffers"] = json::array({buffer});
    if (layout_.fallback_bytes > 0)
      root["buffers"].push_back({{"byteLength", layout_.fallback_bytes}, {"extensions", {{meshopt, {{"fallback", true}}}}}});
  }

  static constexpr const char* meshopt = "EXT_meshopt_compression";

  /// What meshoptimizer decodes has its place in the second buffer, the fallback without data.
  static json view_json(const WrittenView& view) {
    const bool is_compressed = view.meshopt.stride > 0;
    json written = {{"buffer", is_compressed ? 1 : 0}, {"byteOffset", view.offset}, {"byteLength", view.length}};
    if (view.stride) written["byteStride"] = view.stride;
    if (view.target) written["target"] = view.target;
    if (is_compressed)
      written["extensions"][meshopt] = {{"buffer", 0},
                                        {"byteOffset", view.meshopt_offset},
                                        {"byteLength", view.meshopt_length},
                                        {"byteStride", view.meshopt.stride},
                                        {"mode", view.meshopt.mode},
                                        {"count", view.meshopt.count}};
    return written;
  }

  /// Every extension that stands anywhere in the document, in alphabetical order.
  static void collect_extensions(const json& value, std::set<std::string>& names) {
    if (!value.is_structured()) return;
    for (const auto& [key, item] : value.items()) {
      if (value.is_object() && key == "extras") continue;
      if (value.is_object() && key == "extensions" && item.is_object())
        for (const auto& [name, object] : item.items()) names.insert(name);
      collect_extensions(item, names);
    }
  }

  void finish_extensions(json& root) {
    std::set<std::string> used, required;
    collect_extensions(root, used);
    if (packing_ == Packing::quantized && !meshes_.empty()) required.insert("KHR_mesh_quantization");
    if (layout_.fallback_bytes > 0) required.insert(meshopt);
    if (uses_draco_) required.insert("KHR_draco_mesh_compression");
    // A texture without a plain source cannot be drawn without its extension.
    if (root.contains("textures"))
      for (const json& texture : root["textures"])
        if (!texture.contains("source"))
          for (const auto& [name, object] : texture.at("extensions").items()) required.insert(name);
    used.insert(required.begin(), required.end());
    root["extensionsUsed"] = used;
    root["extensionsRequired"] = required;
    if (required.empty()) root.erase("extensionsRequired");
    if (used.empty()) root.erase("extensionsUsed");
  }

  const Scene& scene_;
  const Placement& placement_;
  EncodedScene result_;
  Layout layout_;
  MaterialWriter materials_;
  Packing packing_ = Packing::plain;
  PositionGrid grid_;
  bool uses_draco_ = false;
  json nodes_ = json::array(), meshes_ = json::array(), cameras_ = json::array(), lights_ = json::array();
  std::vector<std::size_t> roots_;
  std::map<std::pair<int, bool>, int> mesh_numbers_;
};

} // namespace

EncodedScene encode_scene(const Scene& scene, const WriteOptions& options, const Placement& placement) {
  try {
    return SceneWriter(scene, options, placement).write();
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorCode::output,
                std::string("a name or a JSON text of the scene cannot be written: ") + error.what());
  }
}

} // namespace domewarp::gltf
