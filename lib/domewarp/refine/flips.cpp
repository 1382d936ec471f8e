// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/flips.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

/// Lengths of the sides in the image.
std::array<double, 3> sides_of(const std::array<const MappedPoint*, 3>& corner) {
  const auto length = [&](int p, int q) { return glm::length(corner[q]->mapped.image - corner[p]->mapped.image); };
  return {length(0, 1), length(1, 2), length(0, 2)};
}

} // namespace

// Source and image turn differently, beyond rounding. Seen from the front, the source's volume is negative. Signs first: few
// faces get past them.
bool is_flipped(const std::array<const MappedPoint*, 3>& corner, int orientation, double thickness) {
  const Vec2 p = corner[1]->mapped.image - corner[0]->mapped.image, q = corner[2]->mapped.image - corner[0]->mapped.image;
  const Vec3 a = corner[0]->eye, u = corner[1]->eye - a, v = corner[2]->eye - a;
  const double twice_area = p.x * q.y - p.y * q.x, volume = glm::dot(a, glm::cross(u, v));
  if ((volume > 0) != (twice_area * orientation > 0)) return false;
  const std::array<double, 3> side = sides_of(corner);
  if (std::abs(twice_area) <= thickness * *std::max_element(side.begin(), side.end())) return false;
  return std::abs(volume) > 1e-12 * glm::length(a) * glm::length(u) * glm::length(v);
}

std::vector<std::uint32_t> sides_of_flipped_faces(const RefinedMesh& mesh, std::size_t first, int orientation, double thickness) {
  constexpr std::size_t block_size = 8192;
  std::vector<std::vector<std::uint32_t>> blocks((mesh.faces.size() - first + block_size - 1) / block_size);
  parallel_each(blocks.size(), 1, [&](std::size_t block) {
    for (std::size_t f = first + block * block_size; f < std::min(mesh.faces.size(), first + (block + 1) * block_size); ++f) {
      const RefinedFace& face = mesh.faces[f];
      const std::array<const MappedPoint*, 3> corner{&mesh.points[face.point[0]], &mesh.points[face.point[1]], &mesh.points[face.point[2]]};
      if (!is_flipped(corner, orientation, thickness)) continue;
      const std::array<double, 3> side = sides_of(corner);
      const double longest = *std::max_element(side.begin(), side.end());
      for (std::size_t k = 0; k < 3; ++k) // equal sides go together, so that the order of corners cannot show
        if (side[k] >= longest * (1 - 1e-9)) blocks[block].push_back(face.edge[k]);
    }
  });
  std::vector<std::uint32_t> edges;
  for (const auto& block : blocks) edges.insert(edges.end(), block.begin(), block.end());
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

} // namespace domewarp
