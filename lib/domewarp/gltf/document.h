// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this folder: the glTF file as plain structs, between the parser and the scene.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/gltf/read.h"
#include "domewarp/scene/scene.h"

namespace domewarp::gltf {

/// Counts the memory a file asks for, so that a small hostile file cannot ask for all of it.
class Budget {
 public:
  explicit Budget(std::size_t bytes) : left_(bytes) {}
  /// @throws Error(input) naming `place` when count x size bytes are not left.
  void charge(std::size_t count, std::size_t size, const std::string& place);

 private:
  std::size_t left_;
};

/// Throws Error(input) "place: defect"; read_scene puts the file's name in front.
[[noreturn]] void refuse(const std::string& place, const std::string& defect);

/// "accessors[3]"
std::string at(const char* list, std::size_t index);

/// A view compressed by EXT_meshopt_compression or KHR_meshopt_compression.
struct MeshoptSource {
  int buffer = -1; ///< -1: not compressed
  std::size_t offset = 0, length = 0, stride = 0, count = 0;
  std::string mode, filter;
};

struct View {
  int buffer = 0;
  std::size_t offset = 0, length = 0;
  std::size_t stride = 0; ///< 0: tightly packed
  MeshoptSource meshopt;
};

struct Sparse {
  std::size_t count = 0; ///< 0: not sparse
  int index_view = -1, value_view = -1;
  std::size_t index_offset = 0, value_offset = 0;
  int index_type = 0;
};

struct Accessor {
  int view = -1; ///< -1: zeros
  std::size_t offset = 0, count = 0;
  int component_type = 0;    ///< glTF's number, 5120 (int8) to 5126 (float)
  int rows = 1, columns = 1; ///< a vector has one column, a scalar one row
  bool normalized = false;
  Sparse sparse;
  std::vector<double> low, high; ///< min and max of the file, empty when absent
  int components() const { return rows * columns; }
};

using AttributeMap = std::vector<std::pair<std::string, int>>; ///< name and accessor, or name and Draco id

struct PrimitiveSource {
  AttributeMap attributes;
  int indices = -1, material = -1, mode = 4;
  std::vector<AttributeMap> targets;
  int draco_view = -1; ///< -1: not compressed
  AttributeMap draco_attributes;
  std::string extras; ///< JSON text, empty when absent; so below
};

struct MeshSource {
  std::string name;
  std::vector<PrimitiveSource> primitives;
  std::vector<double> weights;
  std::string extras = {};
};

struct NodeSource {
  std::string name;
  Mat4 local = Mat4(1);
  bool has_matrix = false;                          ///< `local` is given as such; the three below are not
  std::vector<double> translation, rotation, scale; ///< empty where the file does not say
  int camera = -1, mesh = -1, skin = -1, light = -1;
  bool visible = true;
  std::vector<int> children;
  std::vector<double> weights;
  AttributeMap instancing; ///< EXT_mesh_gpu_instancing, empty when absent
  std::string extras;
};

struct SkinSource {
  std::vector<int> joints;
  int inverse_bind_matrices = -1;
};

struct SceneSource {
  std::string name;
  std::vector<int> nodes;
  std::string extras = {};
};

enum class Interpolation { linear, step, cubic };

struct AnimationChannel {
  std::size_t animation = 0;
  int node = -1, input = -1, output = -1;
  std::string path;
  Interpolation interpolation = Interpolation::linear; ///< cubic: every value stands between two tangents
};

struct Document {
  std::vector<std::vector<std::uint8_t>> buffers; ///< empty for a placeholder without data
  std::vector<View> views;
  std::vector<Accessor> accessors;
  std::vector<MeshSource> meshes;
  std::vector<NodeSource> nodes;
  std::vector<SkinSource> skins;
  std::vector<SceneSource> scenes;
  std::vector<std::string> animations; ///< their names
  std::vector<AnimationChannel> animation_channels;
  int default_scene = -1;
  bool quantization_required = false; ///< KHR_mesh_quantization is among the required extensions
  Scene scene;                        ///< materials, textures, samplers, images, cameras and lights in the file's order
};

/// The bytes of a view, decompressed. @throws Error(input) when its buffer holds no data.
std::span<const std::uint8_t> view_bytes(const Document& document, int view, const std::string& place);

/// Everything of the file but its geometry, checked so that every index and range inside it is valid, and the buffers.
Document read_document(const std::filesystem::path& path, const ReadOptions& options, Budget& budget);

} // namespace domewarp::gltf
