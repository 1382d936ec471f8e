// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// Where the bytes behind "buffer/N" and "image/N" come from. May throw Error; an image may be empty.
struct Blobs {
  std::function<std::vector<std::uint8_t>(std::size_t)> buffer, image;
};

/// Parses a document that `check_structure` has passed and that `lean_json` has rewritten.
/// Fills buffers, views, accessors, meshes, nodes, skins, scenes, cameras, samplers and the bytes of images.
/// @throws Error(input) with what tinygltf says.
void load_tiny(const std::string& json, const Blobs& blobs, Document& document);

} // namespace domewarp::gltf
