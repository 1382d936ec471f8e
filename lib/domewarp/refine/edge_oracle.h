// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "domewarp/refine/error_bound.h"
#include "domewarp/refine/visible_region.h"

namespace domewarp {

/// What is known of one point of the mesh: where it is, on which side of each boundary, and where it appears.
struct MappedPoint {
  Vec3 eye = Vec3(0);       ///< eye space
  Sides sides{1, 1, 1};
  Mapped mapped;            ///< only where no side is -1
};

/// An edge that must be split, and the point that splits it.
struct Split {
  double t = 0.5;           ///< from the end that precedes
  MappedPoint point;
};

/// What was decided about an edge; `error` (image units) and `depth_error` bound the edge as it is.
struct EdgeDecision {
  std::optional<Split> split;
  float error = 0;
  float depth_error = 0;
  bool certified = true;    ///< false when no finite bound exists and samples had to do (folds of the curve)
  std::uint8_t evaluations = 0;
};

struct OracleOptions {
  double tolerance = 0;     ///< image units
  double depth_tolerance = 0; ///< relative
  Projection projection = Projection::perspective;
};

/// Everything decided about an edge is decided here, from its two end points alone, in the order given by `precedes`.
/// In this order: split where it crosses a boundary; split where it dips across one and back; leave it when it is
/// outside; split at the angle's bisector beyond 60 degrees; split at the midpoint while the error bound exceeds the
/// tolerance.
class EdgeOracle {
public:
  EdgeOracle(const Surface& surface, std::size_t branch, const BranchMap& map, VisibleRegion region,
             const OracleOptions& options);

  /// @param a precedes b
  EdgeDecision decide(const MappedPoint& a, const MappedPoint& b) const;

  /// Sides and image of a point. `on`: index of a boundary it is known to lie on, or -1.
  MappedPoint locate(const Vec3& eye, int on = -1) const;

  /// Error bound of an edge that is not in the mesh yet, without evaluating the map: for choosing diagonals.
  double diagonal_error(const MappedPoint& a, const MappedPoint& b) const;

  /// Distance between the exact image of a + l1 (b - a) + l2 (c - a) and its interpolation, image units.
  double interior_error(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& weights) const;

  const VisibleRegion& region() const { return region_; }
  const OracleOptions& options() const { return options_; }

private:
  Mapped map_point(const Vec3& eye) const;
  std::optional<Split> split_at_boundary(const MappedPoint& a, const MappedPoint& b, bool& outside) const;
  bool is_sagging_chord(const MappedPoint& a, const MappedPoint& b) const;
  EdgeDecision split_by_error(const MappedPoint& a, const MappedPoint& b) const;

  const BranchMap& map_;
  VisibleRegion region_;
  OracleOptions options_;
  ErrorBound bound_;
  double rim_angle_;        ///< how far (radians) an edge may dip across a cone unnoticed
};

} // namespace domewarp
