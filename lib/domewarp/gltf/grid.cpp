// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/layout.h"
#include "domewarp/gltf/write.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

namespace {

constexpr int draco_bits = 20, quantized_bits = 16;

/// The smallest grid over everything that is drawn, in the space of the meshes.
PositionGrid grid_of(const Scene& scene, int bits) {
  Vec3 low(std::numeric_limits<double>::infinity()), high(-std::numeric_limits<double>::infinity());
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives)
      for (const Vec3f& position : primitive.positions) {
        low = glm::min(low, Vec3(position));
        high = glm::max(high, Vec3(position));
      }
  PositionGrid grid;
  grid.bits = bits;
  if (!(low.x <= high.x)) return grid;
  grid.origin = low;
  const Vec3 extent = high - low;
  const double largest = std::max({extent.x, extent.y, extent.z});
  if (!std::isfinite(largest))
    throw Error(ErrorCode::output, "a position that is not finite cannot be written as glTF");
  grid.range = largest > 0 ? largest : 1;
  return grid;
}

} // namespace

double grid_step(const PositionGrid& grid) { return grid.range / (std::ldexp(1.0, grid.bits) - 1); }

GridPoint to_grid(const PositionGrid& grid, const Vec3f& position) {
  if (grid.is_draco) return gltf::to_draco_grid(grid, position);
  const double largest = std::ldexp(1.0, grid.bits) - 1, step = grid_step(grid);
  GridPoint point;
  for (int c = 0; c < 3; ++c)
    point[c] = static_cast<int>(std::clamp(std::round((static_cast<double>(position[c]) - grid.origin[c]) / step), 0.0, largest));
  return point;
}

Vec3 from_grid(const PositionGrid& grid, const GridPoint& point) {
  if (grid.is_draco) return Vec3(gltf::from_draco_grid(grid, point));
  return grid.origin + Vec3(point) * grid_step(grid);
}

std::optional<PositionGrid> position_grid(const Scene& scene, const WriteOptions& options) {
  if (!options.draco && !options.quantize) return std::nullopt;
  if (options.grid) return options.grid;
  return options.draco ? gltf::draco_grid(grid_of(scene, draco_bits)) : grid_of(scene, quantized_bits);
}

} // namespace domewarp
