// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "domewarp/core/vectors.h"

namespace domewarp {

/// Where a ray from the eye meets a triangle of a scene.
struct Crossing {
  double distance = 0;        ///< along the unit direction, > 0
  std::uint32_t object = 0;   ///< instance index + 1
  std::uint32_t triangle = 0; ///< in the instance, those of all its triangle primitives counted
  double weights[3] = {};     ///< barycentric, sum 1
  std::uint32_t piece = 0;    ///< of connected surface, where somebody has set it
  Vec3 normal = Vec3(0);      ///< unit, eye space, on the side where the triangle is counter-clockwise
  bool front = false;         ///< that side is the one that is met
};

/// Every crossing along a unit eye-space direction, nearest first.
using CrossingsAlong = std::function<std::vector<Crossing>(const Vec3& direction)>;

} // namespace domewarp
