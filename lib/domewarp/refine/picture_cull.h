// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/refine/edge_oracle.h"
#include "domewarp/scene/raster.h"

namespace domewarp {

/// Asks of faces under refinement whether the picture's rectangle can show anything of them. A face that it cannot show
/// needs no further refinement; its neighbours decide about the shared edges as before.
class PictureCull {
public:
  /// @param map must outlive the object
  /// @param half_extent of the picture's rectangle (kept_half_extent), image units
  PictureCull(const BranchMap& map, const Vec2& half_extent) : map_(map), half_extent_(half_extent) {}

  /// Never wrong about a face of which a part is within the rectangle.
  bool may_be_seen(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c) const;

  /// Whether the images of the corners that have one do not lie beyond one side of the rectangle, all of them.
  bool straddles(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c) const;

private:
  double radius(double theta) const;

  const BranchMap& map_;
  Vec2 half_extent_;
};

} // namespace domewarp
