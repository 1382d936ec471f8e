// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this folder: a scene as the parts of a glTF file.

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "domewarp/gltf/layout.h"
#include "domewarp/gltf/write.h"

namespace domewarp::gltf {

struct ImageFile {
  std::string path; ///< decoded, relative
  const std::vector<std::uint8_t>* bytes = nullptr;
};

struct EncodedScene {
  std::string json;
  std::vector<std::uint8_t> binary;
  std::vector<ImageFile> images; ///< to be written beside the file
};

/// How a file refers to what does not stand in its JSON.
struct Placement {
  std::string binary_uri;                             ///< empty in a GLB
  std::function<std::string(std::size_t)> image_path; ///< for an image of the scene; unset: images are embedded
};

EncodedScene encode_scene(const Scene& scene, const WriteOptions& options, const Placement& placement);

/// New numbers for the things of a scene that are used, in the order of their first use.
class Numbering {
 public:
  int number(int item) {
    const auto [found, is_new] = numbers_.try_emplace(item, static_cast<int>(items_.size()));
    if (is_new) items_.push_back(item);
    return found->second;
  }
  const std::vector<int>& items() const { return items_; }

 private:
  std::map<int, int> numbers_;
  std::vector<int> items_;
};

/// The materials, textures, samplers and images that `used` materials need, renumbered.
class MaterialWriter {
 public:
  MaterialWriter(const Scene& scene, const Placement& placement, Layout& layout, std::vector<ImageFile>& files)
      : scene_(scene), placement_(placement), layout_(layout), files_(files) {}

  /// The number in the written file of a material of the scene; -1 stays -1.
  int use(int material);

  /// How many TEXCOORD sets the textures of a material of the scene need.
  int texcoords(int material);

  /// Appends the lists to the document.
  void finish(nlohmann::ordered_json& root);

 private:
  using json = nlohmann::ordered_json;
  json material_json(const Material& material);
  json texture_json(const Texture& texture);
  json image_json(int image);
  void move_source(json& texture);
  void remap_textures(json& object);
  int use_texture(int texture);
  int use_image(int image);
  int use_sampler(int sampler);

  const Scene& scene_;
  const Placement& placement_;
  Layout& layout_;
  std::vector<ImageFile>& files_;
  bool is_drawable(int texture);

  Numbering materials_, textures_, images_, samplers_;
  std::map<int, int> texcoords_;
  std::map<int, bool> drawable_;
};

} // namespace domewarp::gltf
