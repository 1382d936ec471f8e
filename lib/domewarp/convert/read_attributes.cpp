// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/read_attributes.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "domewarp/gltf/materials.h"

namespace domewarp {

namespace {

struct Reads {
  int texcoords = 0; ///< sets 0 .. texcoords - 1: a file must number them without a gap
  bool normals = true, tangents = false;
};

Reads reads_of(const Material& material, bool unlit) {
  Reads reads;
  for (const TextureReference& reference : {material.base_texture, material.emissive_texture})
    if (reference.texture >= 0) reads.texcoords = std::max(reads.texcoords, reference.texcoord + 1);
  for (const int set : gltf::texcoord_sets(material.json)) reads.texcoords = std::max(reads.texcoords, set + 1);
  reads.normals = !unlit && !material.unlit;
  const auto names = [&](const char* word) { return material.json.find(word) != std::string::npos; };
  reads.tangents = reads.normals && (names("ormalTexture\"") || names("\"KHR_materials_anisotropy\""));
  return reads;
}

} // namespace

std::function<bool(int, const std::string&)> attribute_reader(const Scene& scene, bool unlit) {
  std::vector<Reads> all;
  for (const Material& material : scene.materials) all.push_back(reads_of(material, unlit));
  return [all, unlit](int material, const std::string& attribute) {
    const Reads reads = material >= 0 ? all[static_cast<std::size_t>(material)] : Reads{0, !unlit, false};
    if (attribute.starts_with("_") || attribute == "COLOR_0") return true;
    if (attribute == "NORMAL") return reads.normals;
    if (attribute == "TANGENT") return reads.tangents;
    constexpr std::string_view texcoord = "TEXCOORD_";
    return attribute.starts_with(texcoord) && std::atoi(attribute.c_str() + texcoord.size()) < reads.texcoords;
  };
}

} // namespace domewarp
