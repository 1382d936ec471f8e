// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "domewarp/core/vectors.h"

namespace domewarp {

struct Scene;
struct WriteOptions;

/// One grid of positions for a whole file: position = origin + step * (0 .. 2^bits - 1), step = range / (2^bits - 1).
struct PositionGrid {
  Vec3 origin = Vec3(0);
  double range = 1;
  int bits = 16;         ///< 1 to 30
  bool is_draco = false; ///< what a decoder computes is rounded to single precision
};

using GridPoint = glm::ivec3;

double grid_step(const PositionGrid& grid);

/// The nearest point of the grid, clamped to it.
GridPoint to_grid(const PositionGrid& grid, const Vec3f& position);

/// What a reader of the file will see there, in the space of the meshes.
Vec3 from_grid(const PositionGrid& grid, const GridPoint& point);

/// The grid that `write_scene` rounds positions to, the smallest over everything drawn; none where nothing is rounded.
/// @throws Error(output) when a position is not finite or too far for Draco's single precision
std::optional<PositionGrid> position_grid(const Scene& scene, const WriteOptions& options);

} // namespace domewarp
