// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/flips.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

struct FaceImage {
  std::array<double, 3> side{}; ///< lengths
  double twice_area = 0;
};

FaceImage image_of(const std::array<const MappedPoint*, 3>& corner) {
  const auto at = [&](int k) { return corner[k]->mapped.image; };
  const Vec2 u = at(1) - at(0), v = at(2) - at(0);
  return {{glm::length(u), glm::length(at(2) - at(1)), glm::length(v)}, u.x * v.y - u.y * v.x};
}

/// Whether source and image turn differently, beyond rounding. Seen from the front, the source's volume is negative.
bool is_flipped(const std::array<const MappedPoint*, 3>& corner, const FaceImage& image, int orientation, double thickness) {
  if (std::abs(image.twice_area) <= thickness * *std::max_element(image.side.begin(), image.side.end())) return false;
  const Vec3 a = corner[0]->eye, u = corner[1]->eye - a, v = corner[2]->eye - a;
  const double volume = glm::dot(a, glm::cross(u, v));
  if (std::abs(volume) <= 1e-12 * glm::length(a) * glm::length(u) * glm::length(v)) return false;
  return (volume > 0) == (image.twice_area * orientation > 0);
}

} // namespace

bool is_flipped(const std::array<const MappedPoint*, 3>& corner, int orientation, double thickness) {
  return is_flipped(corner, image_of(corner), orientation, thickness);
}

std::vector<std::uint32_t> sides_of_flipped_faces(const RefinedMesh& mesh, int orientation, double thickness) {
  constexpr std::size_t block_size = 8192;
  std::vector<std::vector<std::uint32_t>> blocks((mesh.faces.size() + block_size - 1) / block_size);
  parallel_each(blocks.size(), 1, [&](std::size_t block) {
    for (std::size_t f = block * block_size; f < std::min(mesh.faces.size(), (block + 1) * block_size); ++f) {
      const RefinedFace& face = mesh.faces[f];
      const std::array<const MappedPoint*, 3> corner{&mesh.points[face.point[0]], &mesh.points[face.point[1]], &mesh.points[face.point[2]]};
      const FaceImage image = image_of(corner);
      if (!is_flipped(corner, image, orientation, thickness)) continue;
      const double longest = *std::max_element(image.side.begin(), image.side.end());
      for (std::size_t k = 0; k < 3; ++k) // equal sides go together, so that the order of corners cannot show
        if (image.side[k] >= longest * (1 - 1e-9)) blocks[block].push_back(face.edge[k]);
    }
  });
  std::vector<std::uint32_t> edges;
  for (const auto& block : blocks) edges.insert(edges.end(), block.begin(), block.end());
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

} // namespace domewarp
