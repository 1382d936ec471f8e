// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "domewarp/core/vectors.h"

namespace domewarp {

/// Distinct positions and which one each input position is.
struct Weld {
  std::vector<Vec3> points;            ///< distinct, in order of first appearance, -0 written as +0
  std::vector<std::uint32_t> point_of; ///< one per input position, index into `points`
};

/// Joins positions that are equal to the bit (-0 equals +0). Nothing is moved; NaNs are equal only to themselves.
/// Parallel; the same for any number of threads. At most 2^32 - 1 positions.
Weld weld(std::span<const Vec3> positions);

/// Joins points that lie within `distance` of each other, chains of such points included: all of a group move to the one
/// that precedes, so the outcome does not depend on the order of the points.
/// @return how many points were moved
std::size_t snap(Weld& weld, double distance);

/// A total order of finite positions that depends on nothing but the positions: x, then y, then z.
inline bool precedes(const Vec3& a, const Vec3& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

} // namespace domewarp
