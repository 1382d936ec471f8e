// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/vertex_order.h"

#include <algorithm>
#include <array>
#include <unordered_set>

#include <meshoptimizer.h>

#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

using Corners = std::array<std::uint32_t, 3>;

struct CornersHash {
  std::size_t operator()(const Corners& c) const {
    std::uint64_t hash = c[0];
    for (const std::uint32_t corner : {c[1], c[2]}) hash = (hash ^ (hash >> 29)) * 0x9E3779B97F4A7C15u + corner;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
};

/// Whether two triangles have the same three positions.
bool has_duplicates(const Primitive& primitive) {
  std::vector<std::uint32_t> welded(primitive.indices.size());
  meshopt_generateShadowIndexBuffer(welded.data(), primitive.indices.data(), primitive.indices.size(),
                                    primitive.positions.data(), primitive.positions.size(), sizeof(Vec3f), sizeof(Vec3f));
  std::unordered_set<Corners, CornersHash> seen;
  seen.reserve(welded.size() / 3);
  for (std::size_t i = 0; i + 2 < welded.size(); i += 3) {
    Corners corners = {welded[i], welded[i + 1], welded[i + 2]};
    std::sort(corners.begin(), corners.end());
    if (!seen.insert(corners).second) return true;
  }
  return false;
}

void order_triangles(Primitive& primitive) {
  std::vector<std::uint32_t> ordered(primitive.indices.size());
  meshopt_optimizeVertexCache(ordered.data(), primitive.indices.data(), ordered.size(), primitive.positions.size());
  primitive.indices = std::move(ordered);
}

/// Numbers vertices by their first use; those that nothing uses are dropped. (meshopt's own numbering takes triangles only.)
void order_vertices(Primitive& primitive) {
  constexpr std::uint32_t unused = ~0U; // as meshopt_remapVertexBuffer has it
  std::vector<std::uint32_t> remap(primitive.positions.size(), unused);
  std::uint32_t used = 0;
  for (std::uint32_t& index : primitive.indices) {
    if (remap[index] == unused) remap[index] = used++;
    index = remap[index];
  }
  std::vector<Vec3f> positions(used);
  meshopt_remapVertexBuffer(positions.data(), primitive.positions.data(), remap.size(), sizeof(Vec3f), remap.data());
  for (Attribute& attribute : primitive.attributes) {
    const auto components = static_cast<std::size_t>(attribute.components);
    std::vector<float> values(used * components);
    meshopt_remapVertexBuffer(values.data(), attribute.values.data(), remap.size(), components * sizeof(float), remap.data());
    attribute.values = std::move(values);
  }
  primitive.positions = std::move(positions);
}

} // namespace

void optimize_vertex_order(Scene& scene) {
  std::vector<Primitive*> primitives;
  for (Mesh& mesh : scene.meshes)
    for (Primitive& primitive : mesh.primitives)
      if (!primitive.indices.empty()) primitives.push_back(&primitive);
  parallel_each(primitives.size(), 1, [&](std::size_t i) {
    Primitive& primitive = *primitives[i];
    const bool blended = primitive.material >= 0 &&
                         scene.materials[static_cast<std::size_t>(primitive.material)].alpha_mode == AlphaMode::blend;
    if (primitive.topology == Topology::triangles && !blended && !has_duplicates(primitive)) order_triangles(primitive);
    order_vertices(primitive);
  });
}

} // namespace domewarp
