// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/read.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <new>
#include <set>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/accessors.h"
#include "domewarp/gltf/animate.h"
#include "domewarp/gltf/animations.h"
#include "domewarp/gltf/document.h"
#include "domewarp/gltf/find_by_name.h"
#include "domewarp/gltf/materials.h"
#include "domewarp/gltf/nodes.h"
#include "domewarp/gltf/pose.h"
#include "domewarp/gltf/primitives.h"
#include "domewarp/gltf/topology.h"
#include "domewarp/gltf/vertex_views.h"

namespace domewarp {

namespace gltf {

namespace {

bool is_mirrored(const Mat4& matrix) {
  return glm::dot(glm::cross(Vec3(matrix[0]), Vec3(matrix[1])), Vec3(matrix[2])) < 0;
}

/// Whether most of the joints mirror what they move.
bool is_mirrored(const std::vector<Mat4>& joints) {
  const auto count = std::count_if(joints.begin(), joints.end(), [](const Mat4& joint) { return is_mirrored(joint); });
  return 2 * static_cast<std::size_t>(count) > joints.size();
}

bool is_usable(const Camera& camera) {
  const bool numbers = std::isfinite(camera.znear) && std::isfinite(camera.zfar);
  if (camera.perspective)
    return numbers && camera.yfov > 0 && camera.yfov < 3.141592653589793 && camera.znear > 0 && camera.aspect >= 0 &&
           (camera.zfar == 0 || camera.zfar > camera.znear);
  return numbers && camera.xmag != 0 && camera.ymag != 0 && camera.zfar > camera.znear && camera.znear >= 0;
}

class SceneReader {
 public:
  SceneReader(Document document, const ReadOptions& options, Budget& budget)
      : document_(std::move(document)), scene_(std::move(document_.scene)), cameras_(std::move(scene_.cameras)),
        lights_(std::move(scene_.lights)), budget_(budget) {
    scene_.cameras.clear();
    scene_.lights.clear();
    check_accessors(document_, budget_, scene_.warnings);
    check_vertex_views(document_, scene_.warnings);
    check_animations(document_, budget_, scene_.warnings);
    if (!options.animation.empty())
      apply_animation(options.animation, options.time, document_, budget_, scene_.warnings);
    scene_.animations = document_.animations.size();
    parents_ = find_parents(document_.nodes);
    world_ = world_matrices(document_.nodes, parents_);
  }

  Scene read(const std::string& name) {
    for (std::size_t i = 0; i < cameras_.size(); ++i)
      if (!is_usable(cameras_[i]))
        scene_.warnings.push_back(at("cameras", i) + ": has factors that make no picture and is left out");
    for (const int root : roots(name)) walk(root);
    if (lost_node_extras_) scene_.dropped_extras.push_back("nodes");
    check_undrawn();
    check_skins();
    return std::move(scene_);
  }

 private:
  int find_scene(const std::string& name) const {
    std::vector<std::string> names;
    for (const SceneSource& scene : document_.scenes) names.push_back(scene.name);
    return static_cast<int>(find_by_name(name, names, "--scene", "scene"));
  }

  /// The nodes to start from: those of the scene asked for, of the default or first scene, or all without parent.
  std::vector<int> roots(const std::string& name) {
    int index = document_.scenes.empty() ? -1 : std::max(document_.default_scene, 0);
    if (!name.empty()) index = find_scene(name);
    if (index >= 0) {
      const SceneSource& source = document_.scenes[static_cast<std::size_t>(index)];
      scene_.name = source.name;
      scene_.scene_extras = source.extras;
      for (const int node : source.nodes)
        if (parents_[static_cast<std::size_t>(node)] >= 0)
          scene_.warnings.push_back(at("scenes", static_cast<std::size_t>(index)) + ": names node " +
                                    std::to_string(node) + ", which is no root");
      return source.nodes;
    }
    std::vector<int> all;
    for (std::size_t i = 0; i < parents_.size(); ++i)
      if (parents_[i] < 0) all.push_back(static_cast<int>(i));
    return all;
  }

  /// Depth first, in the file's order, without recursion.
  void walk(int root) {
    std::vector<int> stack = {root};
    while (!stack.empty()) {
      const int index = stack.back();
      stack.pop_back();
      const NodeSource& node = document_.nodes[static_cast<std::size_t>(index)];
      if (!node.visible || !visited_.insert(index).second) continue;
      draw(static_cast<std::size_t>(index));
      stack.insert(stack.end(), node.children.rbegin(), node.children.rend());
    }
  }

  void draw(std::size_t index) {
    const NodeSource& node = document_.nodes[index];
    if (node.mesh < 0 && node.skin >= 0) scene_.warnings.push_back(at("nodes", index) + ": has a skin but no mesh");
    if (node.mesh < 0 && !node.weights.empty())
      scene_.warnings.push_back(at("nodes", index) + ": has weights but no mesh");
    if (node.mesh >= 0) draw_mesh(node, index);
    lost_node_extras_ = lost_node_extras_ || (node.mesh < 0 && !node.extras.empty());
    if (node.camera >= 0 && is_usable(cameras_[static_cast<std::size_t>(node.camera)])) {
      Camera& camera = scene_.cameras.emplace_back(cameras_[static_cast<std::size_t>(node.camera)]);
      if (!node.name.empty()) camera.name = node.name;
      camera.world = world_[index];
    }
    if (node.light >= 0) {
      Light& light = scene_.lights.emplace_back(lights_[static_cast<std::size_t>(node.light)]);
      if (!node.name.empty()) light.name = node.name;
      light.world = world_[index];
    }
  }

  void draw_mesh(const NodeSource& node, std::size_t index) {
    const MeshSource& source = document_.meshes[static_cast<std::size_t>(node.mesh)];
    drawn_.insert(node.mesh);
    const std::string name = node.name.empty() ? source.name : node.name;
    if (node.skin >= 0) return draw_skinned(node, name);
    if (node.instancing.empty()) return add_instance(node, name, world_[index]);
    std::size_t instance = 0;
    for (const Mat4& local : instance_matrices(node, index)) {
      const Mat4 world = world_[index] * local;
      if (!fits_single_precision(world))
        refuse(at("nodes", index) + ".EXT_mesh_gpu_instancing", "has a world matrix beyond what single precision holds at instance " + std::to_string(instance));
      add_instance(node, name, world);
      ++instance;
    }
  }

  void add_instance(const NodeSource& node, const std::string& name, const Mat4& world) {
    budget_.charge(1, sizeof(Instance) + name.size() + node.extras.size(), "nodes");
    const int mesh = shared_mesh(node, is_mirrored(world));
    if (!scene_.meshes[static_cast<std::size_t>(mesh)].primitives.empty())
      scene_.instances.push_back({name, mesh, world, node.extras});
  }

  /// One mesh for all instances that show the same thing.
  int shared_mesh(const NodeSource& node, bool mirrored) {
    const auto key = std::make_pair(node.mesh, std::make_pair(mirrored, node.weights));
    const auto found = meshes_.find(key);
    if (found != meshes_.end()) return found->second;
    Mesh mesh = read_mesh(node.mesh, node.weights, {});
    if (mirrored)
      for (Primitive& primitive : mesh.primitives) reverse_triangles(primitive.indices, primitive.topology);
    return meshes_[key] = add_mesh(std::move(mesh));
  }

  int add_mesh(Mesh mesh) {
    scene_.meshes.push_back(std::move(mesh));
    return static_cast<int>(scene_.meshes.size() - 1);
  }

  void draw_skinned(const NodeSource& node, const std::string& name) {
    skins_.insert(node.skin);
    const std::vector<Mat4> joints = joint_matrices(document_, node.skin, world_, budget_, scene_.warnings);
    Mesh mesh = read_mesh(node.mesh, node.weights, joints);
    if (mesh.primitives.empty()) return;
    if (is_mirrored(joints))
      for (Primitive& primitive : mesh.primitives) reverse_triangles(primitive.indices, primitive.topology);
    scene_.instances.push_back({name, add_mesh(std::move(mesh)), Mat4(1), node.extras});
  }

  /// Without joints the mesh is not skinned.
  Mesh read_mesh(int index, const std::vector<double>& node_weights, const std::vector<Mat4>& joints) {
    const MeshSource& source = document_.meshes[static_cast<std::size_t>(index)];
    const std::vector<double>& weights = node_weights.empty() ? source.weights : node_weights;
    Mesh mesh{source.name, {}, source.extras};
    for (std::size_t i = 0; i < source.primitives.size(); ++i) {
      const std::string place = at("meshes", static_cast<std::size_t>(index)) + "." + at("primitives", i);
      PrimitiveParts parts = read_primitive(document_, source.primitives[i], place, budget_, scene_.warnings);
      if (source.primitives[i].targets.size() != source.primitives.front().targets.size())
        scene_.warnings.push_back(place + ": has another number of morph targets than the first primitive");
      check_texcoords(parts.primitive, place);
      if (parts.primitive.positions.empty() || parts.primitive.indices.empty()) continue;
      apply_morph_targets(document_, source.primitives[i], weights, place, budget_, scene_.warnings, parts.primitive);
      if (!joints.empty() && !parts.influences.empty())
        apply_skin(parts.influences, joints, place, scene_.warnings, parts.primitive);
      repair_attributes(parts.primitive, place, scene_.warnings);
      parts.primitive.extras = source.primitives[i].extras;
      mesh.primitives.push_back(std::move(parts.primitive));
    }
    return mesh;
  }

  void check_texcoords(const Primitive& primitive, const std::string& place) {
    if (primitive.material < 0) return;
    const auto [known, is_new] = texcoords_.try_emplace(primitive.material);
    if (is_new) known->second = texcoord_sets(scene_.materials[static_cast<std::size_t>(primitive.material)].json);
    for (const int set : known->second)
      if (!find_attribute(primitive, "TEXCOORD_" + std::to_string(set)))
        scene_.warnings.push_back(place + ": has no TEXCOORD_" + std::to_string(set) + ", which its material needs");
  }

  std::vector<Mat4> instance_matrices(const NodeSource& node, std::size_t index) {
    const std::string place = at("nodes", index) + ".EXT_mesh_gpu_instancing";
    std::map<std::string, std::vector<float>> values;
    std::size_t count = SIZE_MAX;
    for (const auto& [name, accessor] : node.instancing) {
      const std::size_t components = name == "ROTATION" ? 4 : 3;
      if (name != "TRANSLATION" && name != "ROTATION" && name != "SCALE") continue;
      if (static_cast<std::size_t>(document_.accessors[static_cast<std::size_t>(accessor)].components()) != components)
        refuse(place + "." + name, "has not " + std::to_string(components) + " components");
      values[name] = read_floats(document_, accessor, budget_);
      const std::size_t here = values[name].size() / components;
      if (count != SIZE_MAX && here != count)
        refuse(place + "." + name, "has " + std::to_string(here) + " instances, others have " + std::to_string(count));
      count = here;
    }
    if (count == SIZE_MAX) return {Mat4(1)};
    budget_.charge(count, sizeof(Mat4), place);
    std::vector<Mat4> matrices;
    const auto part = [&](const char* name, std::size_t i, std::size_t components) {
      const std::vector<float>& all = values[name];
      return all.empty() ? std::vector<double>()
                         : std::vector<double>(all.begin() + static_cast<std::ptrdiff_t>(i * components),
                                               all.begin() + static_cast<std::ptrdiff_t>((i + 1) * components));
    };
    for (std::size_t i = 0; i < count; ++i) {
      matrices.push_back(matrix_of(part("TRANSLATION", i, 3), part("ROTATION", i, 4), part("SCALE", i, 3)));
      if (!std::isfinite(glm::dot(matrices.back() * Vec4(1), Vec4(1))))
        refuse(place, "is not finite at instance " + std::to_string(i));
    }
    return matrices;
  }

  /// Meshes of other scenes, or that only unknown extensions use, are not part of the result. Their defects are named.
  void check_undrawn() {
    for (std::size_t i = 0; i < document_.meshes.size(); ++i) {
      if (drawn_.contains(static_cast<int>(i))) continue;
      try {
        read_mesh(static_cast<int>(i), {}, {});
      } catch (const Error& error) {
        scene_.warnings.push_back(std::string(error.what()) + " (a mesh that is not drawn)");
      }
    }
  }

  void check_skins() {
    for (std::size_t i = 0; i < document_.skins.size(); ++i) try {
        joint_matrices(document_, static_cast<int>(i), world_, budget_, scene_.warnings);
        if (!skins_.contains(static_cast<int>(i))) continue;
        for (const int joint : document_.skins[i].joints)
          if (!visited_.contains(joint))
            scene_.warnings.push_back(at("skins", i) + ": has the joint " + std::to_string(joint) +
                                      ", which is not in the scene");
      } catch (const Error& error) {
        scene_.warnings.push_back(error.what());
      }
  }

  Document document_;
  Scene scene_;
  std::vector<Camera> cameras_;
  std::vector<Light> lights_;
  Budget& budget_;
  std::vector<int> parents_;
  std::vector<Mat4> world_;
  std::map<std::pair<int, std::pair<bool, std::vector<double>>>, int> meshes_;
  std::map<int, std::set<int>> texcoords_; ///< that materials read
  std::set<int> visited_, drawn_, skins_;
  bool lost_node_extras_ = false; ///< of nodes that draw nothing
};

/// Each sentence once, and not more of them than anyone reads.
void shorten(std::vector<std::string>& warnings) {
  constexpr std::size_t most = 100;
  std::set<std::string> seen;
  std::erase_if(warnings, [&](const std::string& warning) { return !seen.insert(warning).second; });
  if (warnings.size() <= most) return;
  const std::size_t more = warnings.size() - most;
  warnings.resize(most);
  warnings.push_back("and " + std::to_string(more) + " more defects");
}

} // namespace

} // namespace gltf

Scene read_scene(const std::filesystem::path& path, const ReadOptions& options) {
  try {
    if (options.animation.empty() && options.time != 0) throw Error(ErrorCode::usage, "--time: needs --animation");
    gltf::Budget budget(options.max_bytes);
    Scene scene = gltf::SceneReader(gltf::read_document(path, options, budget), options, budget).read(options.scene);
    gltf::shorten(scene.warnings);
    return scene;
  } catch (const Error& error) {
    const std::string message = error.what();
    if (error.code() != ErrorCode::input || message.starts_with(path.string())) throw;
    throw Error(ErrorCode::input, path.string() + ": " + message);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::input, path.string() + ": needs more memory than there is");
  } catch (const std::exception& error) {
    throw Error(ErrorCode::input, path.string() + ": cannot be read: " + error.what());
  }
}

} // namespace domewarp
