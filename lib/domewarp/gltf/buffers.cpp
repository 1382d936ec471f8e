// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/buffers.h"

#include <climits>
#include <system_error>

#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/image_format.h"
#include "domewarp/gltf/uri.h"

namespace domewarp::gltf {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

std::size_t byte_length(const json& buffer) {
  return static_cast<std::size_t>(buffer.at("byteLength").get<double>());
}

std::string size_text(std::size_t bytes) {
  return std::to_string(bytes) + " bytes";
}

std::vector<std::uint8_t> read_charged(const fs::path& path, Budget& budget, const std::string& place) {
  std::error_code status;
  const std::uintmax_t size = fs::file_size(path, status);
  if (!status) budget.charge(static_cast<std::size_t>(size), 1, place);
  return read_file(path);
}

fs::path find_file(const std::string& uri, const Source& source, const std::string& place) {
  try {
    return resolve_uri(source.folder, uri, source.allow_external);
  } catch (const Error& error) {
    refuse(place, error.what());
  }
}

std::vector<std::uint8_t> load_uri(const std::string& uri, const Source& source, Budget& budget,
                                   const std::string& place) {
  if (!is_data_uri(uri)) return read_charged(find_file(uri, source, place), budget, place);
  budget.charge(uri.size(), 1, place);
  std::optional<DataUri> data = decode_data_uri(uri);
  if (!data) refuse(place, "its data URI cannot be decoded");
  return std::move(data->bytes);
}

void check_length(std::size_t found, std::size_t length, const std::string& place) {
  if (found < length) refuse(place, "has " + size_text(found) + " of the " + size_text(length) + " it should have");
}

} // namespace

bool is_binary_chunk(const json& root, std::size_t index, const Source& source) {
  return index == 0 && source.has_binary && !root.at("buffers").at(0).contains("uri");
}

void cut_binary_chunk(const json& root, const Source& source, std::vector<std::uint8_t>& file) {
  const std::size_t length = byte_length(root.at("buffers").at(0));
  check_length(source.binary.size(), length, at("buffers", 0));
  file.erase(file.begin(), file.begin() + (source.binary.data() - file.data()));
  file.resize(length);
}

std::vector<std::size_t> buffer_sizes(const json& root, const Source& source, std::vector<std::string>& warnings) {
  std::vector<std::size_t> sizes;
  if (!root.contains("buffers")) return sizes;
  for (const json& buffer : root.at("buffers")) {
    const bool has_bytes = buffer.contains("uri") || is_binary_chunk(root, sizes.size(), source);
    sizes.push_back(has_bytes ? byte_length(buffer) : 0);
    if (byte_length(buffer) == 0) warnings.push_back(at("buffers", sizes.size() - 1) + ": has byteLength 0");
  }
  return sizes;
}

std::vector<std::uint8_t> load_buffer(const json& root, std::size_t index, const Source& source, Budget& budget) {
  const json& buffer = root.at("buffers").at(index);
  const std::string place = at("buffers", index);
  const std::size_t length = byte_length(buffer);
  std::vector<std::uint8_t> bytes;
  if (!buffer.contains("uri")) return {0};
  bytes = load_uri(buffer.at("uri"), source, budget, place);
  check_length(bytes.size(), length, place);
  bytes.resize(length);
  return length > 0 ? bytes : std::vector<std::uint8_t>{0};
}

std::vector<std::uint8_t> load_image(const json& root, std::size_t index, const Source& source, Budget& budget,
                                     std::vector<std::string>& warnings) {
  const json& image = root.at("images").at(index);
  if (!image.contains("uri")) return {};
  const std::string uri = image.at("uri"), place = at("images", index);
  fs::path path;
  if (!is_data_uri(uri)) path = find_file(uri, source, place);
  std::error_code status;
  if (!path.empty() && fs::exists(path, status) && fs::file_size(path, status) > INT_MAX && !status)
    refuse(place, "is larger than 2 GiB");
  try {
    return path.empty() ? load_uri(uri, source, budget, place) : read_charged(path, budget, place);
  } catch (const Error& error) {
    warnings.push_back(place + ": is left out: " + error.what());
    return {};
  }
}

namespace {

std::string mime_of_source(const json& image) {
  if (image.contains("mimeType")) return image.at("mimeType");
  if (!image.contains("uri") || !is_data_uri(image.at("uri").get_ref<const std::string&>())) return {};
  const std::string& uri = image.at("uri").get_ref<const std::string&>();
  return uri.substr(5, uri.find_first_of(";,") - 5);
}

void take_from_view(const json& source, const std::string& place, Image& image, const Document& document,
                    Budget& budget) {
  const std::span<const std::uint8_t> bytes = view_bytes(document, source.at("bufferView").get<int>(), place);
  budget.charge(bytes.size(), 1, place);
  image.bytes.assign(bytes.begin(), bytes.end());
}

void check_content(Image& image, const std::string& declared, const std::string& place,
                   std::vector<std::string>& warnings) {
  const std::string found = sniff_mime(image.bytes);
  const std::string defect =
      found.empty() ? "is no image of a format that glTF knows" : image_defect(image.bytes, found);
  if (!defect.empty()) {
    warnings.push_back(place + ": is left out: " + defect);
    image.bytes.clear();
  }
  if (!found.empty() && !declared.empty() && declared != found)
    warnings.push_back(place + ": is " + found + ", not " + declared + " as its mimeType says");
  image.mime = found.empty() ? declared : found;
}

} // namespace

void finish_images(const json& root, Document& document, Budget& budget) {
  std::vector<std::string>& warnings = document.scene.warnings;
  for (std::size_t i = 0; i < document.scene.images.size(); ++i) {
    const json& source = root.at("images")[i];
    const std::string place = at("images", i), declared = mime_of_source(source);
    Image& image = document.scene.images[i];
    image.mime = declared;
    const bool in_view = source.contains("bufferView"), has_uri = source.contains("uri");
    if (in_view && !has_uri) take_from_view(source, place, image, document, budget);
    if (in_view && has_uri) warnings.push_back(place + ": has both a URI and a bufferView; the URI is taken");
    if (!in_view && !has_uri) warnings.push_back(place + ": is left out: it has neither URI nor bufferView");
    if (has_uri && !is_data_uri(source.at("uri").get_ref<const std::string&>())) image.uri = source.at("uri");
    if (!image.bytes.empty()) check_content(image, declared, place, warnings);
  }
}

namespace {

void check_range(std::size_t offset, std::size_t length, std::size_t size, const std::string& place,
                 const char* buffer) {
  if (length > size || offset > size - length)
    refuse(place, "reaches from byte " + std::to_string(offset) + " over " + size_text(length) + ", but its " + buffer +
                      " has " + size_text(size));
}

} // namespace

void check_views(Document& document, const std::vector<std::size_t>& sizes) {
  for (std::size_t i = 0; i < document.views.size(); ++i) {
    const View& view = document.views[i];
    const std::string place = at("bufferViews", i);
    if (view.length == 0) refuse(place, "has byteLength 0");
    if (view.meshopt.buffer >= 0) {
      const std::size_t size = sizes[static_cast<std::size_t>(view.meshopt.buffer)];
      check_range(view.meshopt.offset, view.meshopt.length, size, place + ".meshopt_compression", "buffer");
    } else if (sizes[static_cast<std::size_t>(view.buffer)] > 0) {
      check_range(view.offset, view.length, sizes[static_cast<std::size_t>(view.buffer)], place, "buffer");
    }
    if (view.stride > view.length)
      document.scene.warnings.push_back(place + ": has a byteStride larger than its byteLength");
  }
}

} // namespace domewarp::gltf
