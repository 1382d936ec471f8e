// SPDX-License-Identifier: Apache-2.0
#include "gltf_file.h"

#include <cstring>
#include <fstream>

#include <unistd.h>

#include "domewarp/core/errors.h"

namespace domewarp::test {

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "domewarp_gltf_XXXXXX").string();
  if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  path = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code status;
  std::filesystem::remove_all(path, status);
}

int GltfFile::add_view(const void* data, std::size_t size) {
  binary.resize((binary.size() + 3) / 4 * 4);
  root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}});
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  binary.insert(binary.end(), bytes, bytes + size);
  return static_cast<int>(root["bufferViews"].size()) - 1;
}

namespace {

std::size_t components_of(const std::string& type) {
  return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
}

template <typename T>
int add_values(GltfFile& file, const std::vector<T>& values, const char* type, int component_type, bool normalized) {
  const int view = file.add_view(values.data(), values.size() * sizeof(T));
  json accessor = {{"bufferView", view},
                   {"componentType", component_type},
                   {"count", values.size() / components_of(type)},
                   {"type", type}};
  if (normalized) accessor["normalized"] = true;
  file.root["accessors"].push_back(accessor);
  return static_cast<int>(file.root["accessors"].size()) - 1;
}

} // namespace

int GltfFile::add(const std::vector<float>& values, const char* type) {
  return add_values(*this, values, type, 5126, false);
}

int GltfFile::add(const std::vector<std::uint16_t>& values, const char* type, bool normalized) {
  return add_values(*this, values, type, 5123, normalized);
}

int GltfFile::add_bytes(const std::vector<std::uint8_t>& values, const char* type, bool normalized) {
  return add_values(*this, values, type, 5121, normalized);
}

int GltfFile::add_node(json node) {
  root["nodes"].push_back(std::move(node));
  const int index = static_cast<int>(root["nodes"].size()) - 1;
  root["scene"] = 0;
  root["scenes"][0]["nodes"].push_back(index);
  return index;
}

int GltfFile::draw(json primitive, json node) {
  root["meshes"].push_back({{"primitives", json::array({std::move(primitive)})}});
  const int mesh = static_cast<int>(root["meshes"].size()) - 1;
  node["mesh"] = mesh;
  add_node(std::move(node));
  return mesh;
}

std::vector<std::uint8_t> GltfFile::glb() const {
  json document = root;
  if (!binary.empty() && !document.contains("buffers"))
    document["buffers"] = json::array({{{"byteLength", binary.size()}}});
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::vector<std::uint8_t> padded = binary;
  padded.resize((padded.size() + 3) / 4 * 4);
  std::vector<std::uint8_t> bytes;
  const auto word = [&](std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  };
  word(0x46546C67), word(2), word(20 + text.size() + (padded.empty() ? 0 : 8 + padded.size()));
  word(text.size()), word(0x4E4F534A);
  bytes.insert(bytes.end(), text.begin(), text.end());
  if (padded.empty()) return bytes;
  word(padded.size()), word(0x004E4942);
  bytes.insert(bytes.end(), padded.begin(), padded.end());
  return bytes;
}

Scene GltfFile::read(const ReadOptions& options) const {
  const TemporaryFolder folder;
  write_bytes(folder / "file.glb", glb());
  return read_scene(folder / "file.glb", options);
}

GltfFile triangle_file() {
  GltfFile file;
  const int positions = file.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  file.root["accessors"][0]["min"] = {0, 0, 0};
  file.root["accessors"][0]["max"] = {1, 1, 0};
  file.draw({{"attributes", {{"POSITION", positions}}}});
  return file;
}

std::string refusal(const std::filesystem::path& path, const ReadOptions& options) {
  try {
    read_scene(path, options);
  } catch (const Error& error) {
    return error.code() == ErrorCode::input ? error.what() : std::string("another code: ") + error.what();
  }
  return {};
}

std::string refusal(const GltfFile& file, const ReadOptions& options) {
  const TemporaryFolder folder;
  write_bytes(folder / "file.glb", file.glb());
  return refusal(folder / "file.glb", options);
}

bool warns(const Scene& scene, const std::string& text) {
  for (const std::string& warning : scene.warnings)
    if (warning.find(text) != std::string::npos) return true;
  return false;
}

std::vector<std::uint8_t> tiny_png() {
  return {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44, 0x52, 0x00,
          0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0xD1, 0x49, 0x20, 0x56, 0x00,
          0x00, 0x00, 0x0B, 0x49, 0x44, 0x41, 0x54, 0x78, 0xDA, 0x63, 0x60, 0xF8, 0x0F, 0x00, 0x01, 0x02, 0x01,
          0x00, 0xD1, 0x1A, 0xCB, 0x8F, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};
}

void write_bytes(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
  // Truncating a file makes ext4 flush the new one; thousands of them take seconds.
  std::filesystem::remove(path);
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_bytes(path, {text.begin(), text.end()});
}

json document_of(const std::vector<std::uint8_t>& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  return json::parse(glb.begin() + 20, glb.begin() + 20 + static_cast<std::ptrdiff_t>(length));
}

} // namespace domewarp::test
