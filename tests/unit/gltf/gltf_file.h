// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "domewarp/gltf/read.h"

namespace domewarp::test {

using nlohmann::json;

/// A folder that lives as long as the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path / name; }

  std::filesystem::path path;
};

/// A glTF file under construction: a document and the bytes of its one buffer.
struct GltfFile {
  json root = {{"asset", {{"version", "2.0"}}}};
  std::vector<std::uint8_t> binary;

  /// Appends values and returns the number of a new accessor over them.
  int add(const std::vector<float>& values, const char* type);
  int add(const std::vector<std::uint16_t>& values, const char* type, bool normalized = false);
  int add_bytes(const std::vector<std::uint8_t>& values, const char* type, bool normalized = false);

  /// A view of raw bytes.
  int add_view(const void* data, std::size_t size);

  /// A node in the scene, with whatever else it has; returns its number.
  int add_node(json node);

  /// A node that draws a new mesh of one primitive; returns the mesh's number.
  int draw(json primitive, json node = json::object());

  std::vector<std::uint8_t> glb() const;
  /// Reads the GLB back through a file.
  Scene read(const ReadOptions& options = {}) const;
};

/// One triangle in the plane z = 0 with the corners (0,0), (1,0), (0,1), drawn by one node.
GltfFile triangle_file();

/// The message of the Error(input) that reading throws, empty when nothing is thrown.
std::string refusal(const GltfFile& file, const ReadOptions& options = {});
std::string refusal(const std::filesystem::path& path, const ReadOptions& options = {});

/// Whether a warning contains the text.
bool warns(const Scene& scene, const std::string& text);

/// A valid PNG of 2 x 1 pixels.
std::vector<std::uint8_t> tiny_png();

void write_bytes(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes);
void write_text(const std::filesystem::path& path, const std::string& text);

/// The JSON chunk of a GLB.
json document_of(const std::vector<std::uint8_t>& glb);

} // namespace domewarp::test
