// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "domewarp/gltf/grid.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

struct WriteOptions {
  bool draco = false;    ///< KHR_draco_mesh_compression
  bool quantize = false; ///< KHR_mesh_quantization; excludes `draco`
  bool meshopt = false;  ///< EXT_meshopt_compression, lossless; excludes `draco`
  std::optional<PositionGrid> grid = {}; ///< of `draco` or `quantize`, around all positions; none: the smallest
};

/// Writes a .glb (one file) or a .gltf with NAME.bin and the image files beside it; the extension decides. What no
/// instance draws is left out: meshes, materials, textures, images, samplers, empty primitives. Material and texture
/// objects of the source file are kept as they are, but for the indices in them. Images are kept byte for byte.
/// Positions are rounded nowhere but, with `draco` or `quantize`, to one grid for the whole file: equal positions stay
/// equal. Every file appears complete or not at all. Same scene, same bytes.
/// @throws Error(output) when a file cannot be written, a position is not finite, a JSON text of the scene is not
/// valid, or the geometry exceeds 4 GiB;
/// Error(usage) when the extension is neither .glb nor .gltf or options exclude each other.
void write_scene(const Scene& scene, const std::filesystem::path& path, const WriteOptions& options = {});

/// How far `draco` or `quantize` move a coordinate of a position at most, in the space of the meshes: half a step of the
/// grid, and the rounding of single precision. 0 without them.
double packing_error(const Scene& scene, const WriteOptions& options);

/// The bytes of the .glb file that `write_scene` writes.
std::vector<std::uint8_t> encode_glb(const Scene& scene, const WriteOptions& options = {});

} // namespace domewarp
