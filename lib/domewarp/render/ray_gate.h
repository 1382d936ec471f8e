// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this folder: what lets a ray's hit be judged after Embree's search instead of in it.

#include <cstddef>
#include <cstdint>
#include <limits>

#include "domewarp/core/vectors.h"
#include "domewarp/render/parts.h"

namespace domewarp {

/// How far edges are moved outwards in their plane, relative to the largest coordinate. Embree's float32 edge test errs
/// by about 2e-7 of that; a plane seen at a slant of 1:150 still leaves the margin needed. For rays that do not begin at
/// the eye it covers origins up to a hundred times as far from the eye as the triangle.
inline constexpr double inflation = 3e-5;

/// All that a proposal of Embree's is judged by, in one place: it is looked up for every ray, and seldom cached.
struct Facet {
  Vec3 corners[3]; ///< eye space
  std::uint32_t part = 0, triangle = 0;
};

/// What tells without a look at the facet that a proposal for a ray from the eye will be accepted.
struct Gate {
  float margin = std::numeric_limits<float>::infinity(); ///< least barycentric coordinate in Embree's triangle
  float slack = 0;                                       ///< relative error of Embree's distance
};

Gate make_gate(const Facet& facet, const Look& look);

/// Proposals for one ray that will be accepted, the nearest few.
class Waiting {
 public:
  /// @param low, high of the distance, in Embree's units. @return false when there is no room
  bool add(std::uint32_t primitive, float low, float high) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i)
      if (entries_[i].low <= high) entries_[kept++] = entries_[i];
    count_ = kept;
    if (count_ == most) return false;
    entries_[count_++] = {primitive, low};
    return true;
  }

  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t i = 0; i < count_; ++i) visit(entries_[i].primitive);
  }

 private:
  static constexpr std::size_t most = 4;
  struct Entry {
    std::uint32_t primitive;
    float low;
  };
  Entry entries_[most];
  std::size_t count_ = 0;
};

} // namespace domewarp
