// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/vertex_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include <meshoptimizer.h>

#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

/// Triangles are ordered in runs of this many, in parallel: a cache forgets the start of a run long before its end.
constexpr std::size_t run_indices = 3 * 65536;

/// Of three vertices in any order; never 0.
std::uint64_t hash_of(std::array<std::uint32_t, 3> corners) {
  std::sort(corners.begin(), corners.end());
  std::uint64_t hash = corners[0];
  for (const std::uint32_t corner : {corners[1], corners[2]}) {
    hash = (hash ^ (hash >> 29)) * 0x9E3779B97F4A7C15u + corner;
    hash = (hash ^ (hash >> 32)) * 0xD6E8FEB86659FD93u;
  }
  return hash | 1;
}

/// Whether two triangles have the same three positions, or seem to, once in ten million scenes of a million triangles.
bool has_duplicates(const Primitive& primitive) {
  std::vector<std::uint32_t> welded(primitive.indices.size());
  meshopt_generateShadowIndexBuffer(welded.data(), primitive.indices.data(), primitive.indices.size(),
                                    primitive.positions.data(), primitive.positions.size(), sizeof(Vec3f), sizeof(Vec3f));
  std::vector<std::uint64_t> seen(std::bit_ceil(welded.size() / 3 * 2 + 1), 0);
  for (std::size_t i = 0; i + 2 < welded.size(); i += 3) {
    const std::uint64_t hash = hash_of({welded[i], welded[i + 1], welded[i + 2]});
    std::size_t slot = hash >> 16 & (seen.size() - 1);
    for (; seen[slot] != 0; slot = (slot + 1) & (seen.size() - 1))
      if (seen[slot] == hash) return true;
    seen[slot] = hash;
  }
  return false;
}

/// The vertices of a run lie close together, as they were numbered in the order of the triangles.
void order_run(std::uint32_t* indices, std::size_t count) {
  const auto [low, high] = std::minmax_element(indices, indices + count);
  const std::uint32_t first = *low;
  const std::size_t vertices = *high - first + 1;
  for (std::size_t i = 0; i < count; ++i) indices[i] -= first;
  std::vector<std::uint32_t> ordered(count);
  meshopt_optimizeVertexCache(ordered.data(), indices, count, vertices);
  for (std::size_t i = 0; i < count; ++i) indices[i] = ordered[i] + first;
}

void order_triangles(Primitive& primitive) {
  const std::size_t count = primitive.indices.size() / 3 * 3;
  parallel_each((count + run_indices - 1) / run_indices, 1, [&](std::size_t run) {
    order_run(primitive.indices.data() + run * run_indices, std::min(run_indices, count - run * run_indices));
  });
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
  parallel_each(primitive.attributes.size(), 1, [&](std::size_t a) {
    Attribute& attribute = primitive.attributes[a];
    const auto components = static_cast<std::size_t>(attribute.components);
    std::vector<float> values(used * components);
    meshopt_remapVertexBuffer(values.data(), attribute.values.data(), remap.size(), components * sizeof(float), remap.data());
    attribute.values = std::move(values);
  });
  primitive.positions = std::move(positions);
}

} // namespace

void optimize_vertex_order(Scene& scene) {
  std::vector<Primitive*> primitives;
  for (Mesh& mesh : scene.meshes)
    for (Primitive& primitive : mesh.primitives)
      if (!primitive.indices.empty() && !primitive.keeps_order) primitives.push_back(&primitive);
  parallel_each(primitives.size(), 1, [&](std::size_t i) {
    Primitive& primitive = *primitives[i];
    const bool blended = primitive.material >= 0 &&
                         scene.materials[static_cast<std::size_t>(primitive.material)].alpha_mode == AlphaMode::blend;
    if (primitive.topology == Topology::triangles && !blended && !has_duplicates(primitive)) order_triangles(primitive);
    order_vertices(primitive);
  });
}

} // namespace domewarp
