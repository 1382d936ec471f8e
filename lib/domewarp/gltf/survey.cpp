// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/survey.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "domewarp/gltf/container.h"
#include "domewarp/gltf/document.h"
#include "domewarp/gltf/image_format.h"
#include "domewarp/gltf/uri.h"

namespace domewarp {

namespace gltf {

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t most_json = std::size_t(1) << 30;

/// The JSON chunk of a GLB without its binary, or the whole of a .gltf.
std::string read_json_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<unsigned char, 20> header{};
  in.read(reinterpret_cast<char*>(header.data()), header.size());
  const bool is_glb = in.gcount() == 20 && std::memcmp(header.data(), "glTF", 4) == 0;
  std::size_t size = static_cast<std::size_t>(fs::file_size(path));
  if (is_glb) size = std::min<std::size_t>(size, header[12] | header[13] << 8 | header[14] << 16 | std::size_t(header[15]) << 24);
  in.clear();
  in.seekg(is_glb ? 20 : 0);
  std::string text(std::min(size, most_json), '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

/// How much of an image is read to find its size: a JPEG may hold a thumbnail before it.
constexpr std::size_t most_image_head = 1 << 16;
constexpr std::size_t most_images = 4096; ///< whose sizes are found

/// Where the data of a GLB's second chunk begin.
std::size_t binary_begin(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<unsigned char, 20> header{};
  in.read(reinterpret_cast<char*>(header.data()), header.size());
  return 28 + (header[12] | header[13] << 8 | header[14] << 16 | std::size_t(header[15]) << 24);
}

const json& list(const json& root, const char* name) {
  static const json none = json::array();
  const auto found = root.find(name);
  return found == root.end() || !found->is_array() ? none : *found;
}

const json& entry(const json& root, const char* name, const json& index) {
  if (!index.is_number_unsigned()) throw std::out_of_range(name);
  return list(root, name).at(index.get<std::size_t>());
}

double count_of(const json& root, const json& index) { return entry(root, "accessors", index).value("count", 0.0); }

double components_of(const std::string& type) {
  const double n = type.back() - '0';
  return type.starts_with("VEC") ? n : type.starts_with("MAT") ? n * n : 1;
}

void find_side_files(const json& root, const fs::path& folder, bool allow_external, FileSurvey& survey) {
  for (const char* name : {"buffers", "images"})
    for (const json& source : list(root, name)) {
      const std::string uri = source.value("uri", "");
      if (uri.empty() || is_data_uri(uri)) continue;
      try {
        survey.side_files.push_back(resolve_uri(folder, uri, allow_external));
      } catch (const std::exception&) {
        continue; // read_scene names it
      }
      std::error_code status;
      const std::uintmax_t size = fs::file_size(survey.side_files.back(), status);
      if (!status) survey.file_bytes += static_cast<double>(size);
    }
}

double triangles_of(const json& root, const json& mesh) {
  double corners = 0;
  for (const json& primitive : list(mesh, "primitives")) {
    const json& attributes = primitive.at("attributes");
    if (primitive.value("mode", 4) < 4 || !attributes.contains("POSITION")) continue;
    corners += count_of(root, primitive.contains("indices") ? primitive.at("indices") : attributes.at("POSITION"));
  }
  return corners / 3;
}

double instances_of(const json& root, const json& node) {
  const json::json_pointer place("/extensions/EXT_mesh_gpu_instancing/attributes");
  if (!node.contains(place) || !node.at(place).is_object() || node.at(place).empty()) return 1;
  return count_of(root, node.at(place).begin().value());
}

void count_geometry(const json& root, FileSurvey& survey) {
  for (const json& accessor : list(root, "accessors"))
    survey.decoded_bytes += 4 * accessor.value("count", 0.0) * components_of(accessor.value("type", "SCALAR"));
  for (const json& node : list(root, "nodes"))
    if (node.contains("mesh"))
      survey.drawn_triangles += instances_of(root, node) * triangles_of(root, entry(root, "meshes", node.at("mesh")));
}

/// The first bytes of an image: where it stands in a file of its own or in the file's own binary chunk.
std::vector<std::uint8_t> image_head(const json& root, const json& image, const fs::path& path, bool allow_external) {
  fs::path file = path;
  std::size_t offset = 0, size = most_image_head;
  if (const std::string uri = image.value("uri", ""); !uri.empty()) {
    if (is_data_uri(uri)) return {};
    file = resolve_uri(path.parent_path().empty() ? "." : path.parent_path(), uri, allow_external);
  } else {
    const json& view = entry(root, "bufferViews", image.at("bufferView"));
    if (entry(root, "buffers", view.at("buffer")).contains("uri")) return {};
    offset = binary_begin(path) + view.value("byteOffset", std::size_t(0));
    size = std::min(size, view.value("byteLength", std::size_t(0)));
  }
  if (!fs::is_regular_file(file)) return {};
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(offset));
  std::vector<std::uint8_t> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

/// The images that rays look at: those of base colours and glow.
std::set<std::size_t> seen_images(const json& root) {
  std::set<std::size_t> images;
  for (const json& material : list(root, "materials"))
    for (const char* place : {"/pbrMetallicRoughness/baseColorTexture/index", "/emissiveTexture/index"}) {
      const json::json_pointer pointer(place);
      if (!material.contains(pointer)) continue;
      const json& texture = entry(root, "textures", material.at(pointer));
      const json::json_pointer webp("/extensions/EXT_texture_webp/source");
      if (const json source = texture.contains(webp) ? texture.at(webp) : texture.value("source", json()); source.is_number_unsigned())
        images.insert(source.get<std::size_t>());
    }
  return images;
}

void count_textures(const json& root, const fs::path& path, bool allow_external, FileSurvey& survey) {
  std::size_t left = most_images;
  for (const std::size_t index : seen_images(root)) try {
      if (left-- == 0) return;
      survey.texture_pixels += image_pixels(image_head(root, entry(root, "images", index), path, allow_external));
    } catch (const std::exception&) {
      continue; // read_scene names it
    }
}

} // namespace

} // namespace gltf

FileSurvey survey_file(const std::filesystem::path& path, bool allow_external) {
  FileSurvey survey;
  try {
    survey.file_bytes = static_cast<double>(std::filesystem::file_size(path));
    const std::string text = gltf::read_json_text(path);
    gltf::Budget budget(std::size_t(4) << 30);
    gltf::check_nesting(text, budget);
    const nlohmann::json root = nlohmann::json::parse(text);
    const std::filesystem::path folder = path.parent_path();
    gltf::find_side_files(root, folder.empty() ? "." : folder, allow_external, survey);
    gltf::count_geometry(root, survey);
    gltf::count_textures(root, path, allow_external, survey);
  } catch (const std::exception&) { // what was understood so far
  }
  return survey;
}

} // namespace domewarp
