// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this folder: lossless streams of EXT_meshopt_compression.

#include <cstdint>
#include <span>
#include <vector>

namespace domewarp::gltf {

/// What stands in a view's EXT_meshopt_compression beside the place of the bytes.
struct MeshoptStream {
  std::vector<std::uint8_t> bytes;
  const char* mode = "";
  std::size_t count = 0, stride = 0;
};

/// @param vertices   count x stride bytes, decoded as they are. @param stride a multiple of 4, at most 256.
MeshoptStream encode_vertices(std::span<const std::uint8_t> vertices, std::size_t count, std::size_t stride);

/// Triangles are decoded in their order and winding, each from any of its corners on; other indices as they are.
/// @param stride   2 or 4 bytes that an index takes once it is decoded.
MeshoptStream encode_indices(const std::vector<std::uint32_t>& indices, bool are_triangles, std::size_t stride);

} // namespace domewarp::gltf
