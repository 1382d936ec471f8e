// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this folder: what the writer puts into the buffer, as plain structs that become JSON at the end.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/gltf/grid.h"
#include "domewarp/gltf/meshopt_encode.h"
#include "domewarp/scene/scene.h"

namespace domewarp::gltf {

struct WrittenView {
  std::size_t offset = 0, length = 0, stride = 0; ///< stride 0: none
  int target = 0;                                 ///< 34962 vertices, 34963 indices, 0 neither
  MeshoptStream meshopt;                          ///< stride 0: not compressed; without its bytes, which stand in ours
  std::size_t meshopt_offset = 0, meshopt_length = 0; ///< of the stream in the buffer; `offset` is in the fallback
};

struct WrittenAccessor {
  int view = -1; ///< -1: zeros, or the data are compressed
  std::size_t count = 0;
  int component_type = 5126;
  std::string type;
  bool normalized = false;
  std::vector<double> low, high; ///< empty: left out
};

struct WrittenPrimitive {
  std::vector<std::pair<std::string, int>> attributes; ///< name and accessor
  int indices = -1, material = -1, mode = 4;
  int draco_view = -1;
  std::vector<std::pair<std::string, int>> draco_attributes; ///< name and Draco's unique id
};

/// The buffer of a file and what lies in it.
class Layout {
 public:
  /// Appends bytes at a multiple of four. @return the view's index.
  int add_view(std::span<const std::uint8_t> bytes, int target = 0, std::size_t stride = 0);

  /// Appends `count` equal elements of vertices; compressed where `use_meshopt` says so and it pays.
  /// @param stride   for the view: 0 when no bytes lie between the elements.
  int add_vertices(std::span<const std::uint8_t> bytes, std::size_t count, std::size_t stride = 0);

  /// Appends a stream. What it decodes to has its place in a second buffer, which has a length and no data.
  int add_stream(MeshoptStream stream, int target);

  int add_accessor(WrittenAccessor accessor);

  bool use_meshopt = false;
  std::vector<std::uint8_t> bytes;
  std::size_t fallback_bytes = 0; ///< 0: nothing is compressed by meshoptimizer
  std::vector<WrittenView> views;
  std::vector<WrittenAccessor> accessors;
};

/// The smallest grid around this one whose numbers Draco keeps: it stores its options as text with six decimals.
PositionGrid draco_grid(const PositionGrid& grid);

GridPoint to_draco_grid(const PositionGrid& grid, const Vec3f& position);
Vec3f from_draco_grid(const PositionGrid& grid, const GridPoint& point);

enum class Packing { plain, quantized, draco };

/// "SCALAR", "VEC2", ... for 1, 2, 3, 4, 9 and 16 components.
std::string type_name(int components);

/// The attributes of a primitive as they can be written: finite, unit normals and tangents, no tangents without
/// normals, no gaps in the numbers of TEXCOORD and COLOR.
std::vector<Attribute> writable_attributes(const Primitive& primitive);

/// Appends a primitive that has elements. TEXCOORD sets below `texcoords` that it lacks are written as zeros.
/// @param mirrored   swaps the winding of triangles.
WrittenPrimitive write_primitive(const Primitive& primitive, bool mirrored, int texcoords, Packing packing,
                                 const PositionGrid& grid, Layout& layout);

/// The same with KHR_draco_mesh_compression. Degenerate triangles and vertices that no triangle uses are dropped.
/// @param indices   triangles, not all of them degenerate.
void compress_primitive(const std::vector<Vec3f>& positions, const std::vector<Attribute>& attributes,
                        const std::vector<std::uint32_t>& indices, const PositionGrid& grid, Layout& layout,
                        WrittenPrimitive& written);

} // namespace domewarp::gltf
