// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/write.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <set>
#include <system_error>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/encode.h"
#include "domewarp/gltf/image_format.h"
#include "domewarp/gltf/uri.h"

namespace domewarp {

namespace fs = std::filesystem;

namespace gltf {

namespace {

void append_word(std::vector<std::uint8_t>& bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// A GLB in two parts, so that the large one is not copied.
struct Glb {
  std::vector<std::uint8_t> head;   ///< up to the data of the BIN chunk
  std::vector<std::uint8_t> binary; ///< these data, padded; empty: no such chunk
};

Glb pack_glb(EncodedScene encoded) {
  Glb glb;
  glb.binary = std::move(encoded.binary);
  glb.binary.resize((glb.binary.size() + 3) / 4 * 4, 0);
  encoded.json.resize((encoded.json.size() + 3) / 4 * 4, ' ');
  const std::size_t length = 20 + encoded.json.size() + (glb.binary.empty() ? 0 : 8 + glb.binary.size());
  if (length > UINT32_MAX)
    throw Error(ErrorCode::output, "the scene needs " + std::to_string(length) + " bytes, a GLB can hold 4 GiB");
  for (const std::size_t word : {std::size_t(0x46546C67), std::size_t(2), length, encoded.json.size(), std::size_t(0x4E4F534A)})
    append_word(glb.head, word);
  glb.head.insert(glb.head.end(), encoded.json.begin(), encoded.json.end());
  if (glb.binary.empty()) return glb;
  append_word(glb.head, glb.binary.size());
  append_word(glb.head, 0x004E4942);
  return glb;
}

Glb encode(const Scene& scene, const WriteOptions& options) { return pack_glb(encode_scene(scene, options, {})); }

bool is_hidden(const fs::path& path) {
  return std::any_of(path.begin(), path.end(), [](const fs::path& part) { return part.string().starts_with("."); });
}

/// Whether an image may be written where its source stood: below the folder of the file, under an image's name, and
/// not over another file.
bool may_keep_path(const fs::path& folder, const std::string& path, const Image& image) {
  if (!stays_inside(path) || is_hidden(path) || fs::path(path).lexically_normal() != fs::path(path)) return false;
  const std::string expected = file_extension(image.mime), extension = fs::path(path).extension().string();
  if (extension != "." + expected && !(expected == "jpg" && extension == ".jpeg")) return false;
  std::error_code status;
  if (!fs::exists(folder / path, status)) return true;
  if (!fs::is_regular_file(folder / path, status) || fs::file_size(folder / path, status) != image.bytes.size())
    return false;
  return read_file(folder / path) == image.bytes;
}

/// Chooses a path for every image, each at most once.
class ImagePaths {
 public:
  ImagePaths(const Scene& scene, const fs::path& target) : scene_(scene), target_(target) {}

  std::string operator()(std::size_t index) {
    const Image& image = scene_.images[index];
    const std::optional<std::string> kept = percent_decode(image.uri);
    if (kept && may_keep_path(target_.parent_path(), *kept, image) && taken_.insert(*kept).second) return *kept;
    std::string path =
        target_.stem().string() + ".image" + std::to_string(index) + "." + file_extension(image.mime);
    taken_.insert(path);
    return path;
  }

 private:
  const Scene& scene_;
  const fs::path& target_;
  std::set<std::string> taken_;
};

void write_image(const fs::path& path, const std::vector<std::uint8_t>& bytes) {
  std::error_code status;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), status);
  if (status) throw Error(ErrorCode::output, path.string() + ": its folder cannot be made: " + status.message());
  write_file(path, bytes);
}

/// The .gltf goes last: who sees it, sees everything it refers to.
void write_separate(const Scene& scene, const fs::path& path, const WriteOptions& options) {
  const fs::path binary = fs::path(path).replace_extension(".bin");
  ImagePaths paths(scene, path);
  const Placement placement{percent_encode(binary.filename().string()),
                            [&](std::size_t index) { return paths(index); }};
  const EncodedScene encoded = encode_scene(scene, options, placement);
  for (const ImageFile& image : encoded.images) write_image(path.parent_path() / image.path, *image.bytes);
  if (!encoded.binary.empty()) write_file(binary, encoded.binary);
  write_file(path, encoded.json);
}

} // namespace

} // namespace gltf

double packing_error(const Scene& scene, const WriteOptions& options) {
  const std::optional<PositionGrid> grid = position_grid(scene, options);
  if (!grid) return 0;
  const double largest = grid->range + glm::length(grid->origin);
  return 0.5 * grid_step(*grid) + largest * std::numeric_limits<float>::epsilon();
}

std::vector<std::uint8_t> encode_glb(const Scene& scene, const WriteOptions& options) {
  gltf::Glb glb = gltf::encode(scene, options);
  glb.head.insert(glb.head.end(), glb.binary.begin(), glb.binary.end());
  return std::move(glb.head);
}

void write_scene(const Scene& scene, const fs::path& path, const WriteOptions& options) {
  const std::string extension = path.extension().string();
  if (extension != ".glb" && extension != ".gltf")
    throw Error(ErrorCode::usage, path.string() + ": the name must end in .glb or .gltf");
  try {
    if (extension == ".gltf") return gltf::write_separate(scene, path, options);
    const gltf::Glb glb = gltf::encode(scene, options);
    write_file(path, {glb.head, glb.binary});
  } catch (const Error& error) {
    const std::string message = error.what();
    if (error.code() != ErrorCode::output || message.starts_with(path.string())) throw;
    throw Error(ErrorCode::output, path.string() + ": " + message);
  } catch (const std::exception& error) {
    throw Error(ErrorCode::output, path.string() + ": cannot be written: " + error.what());
  }
}

} // namespace domewarp
