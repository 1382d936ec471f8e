// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/document.h"

#include <cmath>
#include <system_error>

#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/buffers.h"
#include "domewarp/gltf/container.h"
#include "domewarp/gltf/extensions.h"
#include "domewarp/gltf/extras.h"
#include "domewarp/gltf/lean_json.h"
#include "domewarp/gltf/materials.h"
#include "domewarp/gltf/meshopt.h"
#include "domewarp/gltf/structure.h"
#include "domewarp/gltf/tiny_document.h"

namespace domewarp::gltf {

using nlohmann::json;

void Budget::charge(std::size_t count, std::size_t size, const std::string& place) {
  if (size != 0 && count > left_ / size)
    refuse(place, "needs " + std::to_string(std::llround(static_cast<double>(count) * static_cast<double>(size) / 1048576)) +
                      " MiB, more than the limit leaves");
  left_ -= count * size;
}

void refuse(const std::string& place, const std::string& defect) {
  throw Error(ErrorCode::input, place + ": " + defect);
}

std::string at(const char* list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

std::span<const std::uint8_t> view_bytes(const Document& document, int index, const std::string& place) {
  const View& view = document.views[static_cast<std::size_t>(index)];
  const std::vector<std::uint8_t>& buffer = document.buffers[static_cast<std::size_t>(view.buffer)];
  if (buffer.empty())
    refuse(place, at("bufferViews", static_cast<std::size_t>(index)) + " lies in a buffer without data");
  return std::span(buffer).subspan(view.offset, view.length);
}

namespace {

json parse_json(std::string_view text, Budget& budget) {
  check_nesting(text, budget);
  try {
    return json::parse(text);
  } catch (const json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
    const std::string message = error.what();
    const std::size_t end = message.find("] ");
    refuse("JSON", end == std::string::npos ? message : message.substr(end + 2));
  }
}

void check_version(const json& asset) {
  const std::string version = asset.value("minVersion", asset.at("version").get<std::string>());
  if (version.starts_with("2.") && version.size() > 2 &&
      version.find_first_not_of("0123456789", 2) == std::string::npos)
    return;
  refuse("asset.version", "is \"" + version.substr(0, 60) + "\", only glTF 2.0 can be read");
}

void check_strides(const json& root) {
  if (!root.contains("bufferViews")) return;
  std::size_t index = 0;
  for (const json& view : root.at("bufferViews")) {
    const double stride = view.value("byteStride", 0.0);
    if (stride > 252 || static_cast<int>(stride) % 4 != 0)
      refuse(at("bufferViews", index) + ".byteStride",
             "is " + view.at("byteStride").dump() + ", not a multiple of 4 up to 252");
    ++index;
  }
}

/// @param file the bytes that `source` refers to; they become the first buffer where they hold it
void load_structs(const json& root, const Source& source, const std::vector<std::size_t>& sizes, std::vector<std::uint8_t> file,
                  Document& document, Budget& budget) {
  const bool has_binary = !sizes.empty() && is_binary_chunk(root, 0, source);
  std::vector<std::size_t> loaded = sizes;
  if (has_binary) loaded[0] = 0;
  Blobs blobs;
  blobs.buffer = [&](std::size_t i) { return load_buffer(root, i, source, budget); };
  blobs.image = [&](std::size_t i) { return load_image(root, i, source, budget, document.scene.warnings); };
  load_tiny(lean_json(root, loaded).dump(), blobs, document);
  for (std::size_t i = 0; i < loaded.size(); ++i)
    if (loaded[i] == 0) document.buffers[i].clear();
  if (!has_binary) return;
  cut_binary_chunk(root, source, file);
  document.buffers[0] = std::move(file);
}

void read_asset(const json& asset, Scene& scene) {
  scene.copyright = asset.value("copyright", "");
  const auto extras = asset.find("extras");
  if (extras != asset.end() && extras->is_object() && extras->contains("domewarp"))
    scene.extras = extras->at("domewarp").dump();
}

} // namespace

Document read_document(const std::filesystem::path& path, const ReadOptions& options, Budget& budget) {
  std::error_code status;
  const std::uintmax_t size = std::filesystem::file_size(path, status);
  if (!status) budget.charge(static_cast<std::size_t>(size), 1, "file");
  std::vector<std::uint8_t> bytes = read_file(path);
  Document document;
  const Container container = split_container(bytes, document.scene.warnings);
  const json root = parse_json(container.json, budget);
  check_structure(root, document.scene.warnings);
  check_version(root.at("asset"));
  check_extensions(root, document.scene);
  check_strides(root);
  const Source source{path.parent_path().empty() ? "." : path.parent_path(), options.allow_external, container.binary,
                      container.has_binary};
  const std::vector<std::size_t> sizes = buffer_sizes(root, source, document.scene.warnings);
  load_structs(root, source, sizes, std::move(bytes), document, budget);
  document.quantization_required = is_required(root, "KHR_mesh_quantization");
  document.scene.lights = read_lights(root, document.scene.warnings);
  read_extensions(root, document);
  read_extras(root, document);
  check_views(document, sizes);
  decode_meshopt(document, budget);
  finish_images(root, document, budget);
  read_materials(root, document.scene);
  read_asset(root.at("asset"), document.scene);
  read_animations(root, document);
  return document;
}

} // namespace domewarp::gltf
