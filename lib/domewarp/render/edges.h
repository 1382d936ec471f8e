// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/image.h"

namespace domewarp {

/// How far edges in a picture lie from where they should be, across the edge, in pixels of the source picture that the
/// first one was made from.
struct EdgeReport {
  std::size_t count = 0; ///< places at edges that were measured; the rest is 0 when there are none
  double median = 0, p99 = 0; ///< of the distance
  double within_pixel = 0; ///< share of the places whose distance is at most 1
  Vec2 bias{0, 0};       ///< the shift of the source picture, right and down, that explains the distances best
  double median_view_px = 0; ///< the median in pixels of the two pictures
};

/// Where a place of the two pictures lies in the source picture (pixels, both); nothing outside it.
using SourcePixel = std::function<std::optional<Vec2>(const Vec2& pixel)>;

/// Finds isolated edges of the reference, along rows and columns, and measures how the light on both sides of each
/// moved: the area between the two profiles over the step between the two sides, which blur does not change.
/// @throws Error(usage) when the pictures differ in size
EdgeReport compare_edges(const Pixels& picture, const Pixels& reference, const SourcePixel& source);

} // namespace domewarp
