// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/pieces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/view.h"

namespace domewarp {

namespace {

/// A vertex with the bits of its position.
struct Vertex {
  std::array<std::uint64_t, 3> bits;
  std::uint32_t number; ///< of all vertices
};

std::vector<Vertex> vertices_of(const Parts& parts) {
  std::vector<Vertex> vertices;
  for (const Part& part : parts.parts)
    for (const Vec3f& p : part.primitive->positions) {
      const Vec3 world = to_world(part.world, p);
      const auto number = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back({{std::bit_cast<std::uint64_t>(world.x + 0.0), std::bit_cast<std::uint64_t>(world.y + 0.0),
                           std::bit_cast<std::uint64_t>(world.z + 0.0)}, // -0 becomes +0
                          number});
    }
  return vertices;
}

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

void join(std::vector<std::uint32_t>& parent, std::uint32_t a, std::uint32_t b) {
  a = root_of(parent, a), b = root_of(parent, b);
  parent[std::max(a, b)] = std::min(a, b);
}

} // namespace

Pieces::Pieces(const Parts& parts) {
  std::vector<Vertex> vertices = vertices_of(parts);
  std::vector<std::uint32_t> parent(vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  std::sort(vertices.begin(), vertices.end(), [](const Vertex& a, const Vertex& b) { return a.bits < b.bits; });
  for (std::size_t i = 1; i < vertices.size(); ++i)
    if (vertices[i].bits == vertices[i - 1].bits) join(parent, vertices[i].number, vertices[i - 1].number);
  std::uint32_t first = 0;
  for (const Part& part : parts.parts) {
    const std::vector<std::uint32_t>& indices = part.primitive->indices;
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
      join(parent, first + indices[t], first + indices[t + 1]);
      join(parent, first + indices[t], first + indices[t + 2]);
    }
    first += static_cast<std::uint32_t>(part.primitive->positions.size());
  }
  first = 0;
  for (const Part& part : parts.parts) {
    first_of_.push_back(piece_of_.size());
    for (std::size_t t = 0; t + 2 < part.primitive->indices.size(); t += 3)
      piece_of_.push_back(root_of(parent, first + part.primitive->indices[t]));
    first += static_cast<std::uint32_t>(part.primitive->positions.size());
  }
}

} // namespace domewarp
