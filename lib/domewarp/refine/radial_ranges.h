// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "domewarp/profile/surface.h"

namespace domewarp {

struct Range {
  double low = 0, high = 0;
};
inline double magnitude(const Range& a) { return std::max(-a.low, a.high); }

/// What the derivatives of the image G = R(theta) e_r and of the weight g(theta) are made of, over a range of angles.
struct RadialRange {
  Range along;        ///< A = R''
  Range across;       ///< B = (R' sin cos - R) / sin^2
  Range twist;        ///< C = (R' sin - R cos) / sin^2 = K'
  Range slope;        ///< R'
  Range factor;       ///< K = R / sin
  Range weight;       ///< g
  Range weight_slope; ///< g'
  double slope_jump = 0;  ///< by how much R' changes beyond what `along` accounts for (kinks), sum over the range
  double weight_jump = 0; ///< the same of g
};

/// What a bound that asks for no direction needs of a RadialRange.
struct BriefRange {
  double bend = 0;           ///< of (max(|A|, |B|)^2 + C^2)^(1/2); infinite where R' or g jumps
  double speed = 0;          ///< of max(|R'|, |K|)
  double inverse_weight = 1; ///< of 1 / g
  Range weight_slope;
};

/// Ranges over one branch, from interval enclosures of R, R', R'': certain, not sampled. Cells are equal in the
/// half-angle index u (transform/radial_table.h), so that a look-up needs no trigonometry; any range costs two of them.
/// Some more of them beyond each end know how R goes on there (transform/continuation.h); farther off nothing has a bound.
class RadialRanges {
public:
  RadialRanges(const Surface& surface, std::size_t branch, double theta_low, double theta_high);

  /// @param u_low,u_high half-angle indices, in order; in [0, 1]
  RadialRange over(double u_low, double u_high) const;
  BriefRange brief(double u_low, double u_high) const;

private:
  static constexpr std::size_t inner_cells = 1024, margin = 64, cells = inner_cells + 2 * margin;
  static constexpr int quantities = 7, half = 8;
  /// Bounds rounded outwards, -low first, then high from `half` on, so that all are maxima; the rest is 0.
  struct alignas(64) Row {
    std::array<float, 2 * half> bound{};
  };
  struct alignas(32) BriefRow {
    std::array<float, 8> bound{}; ///< bend, speed, 1 / g, -low and high of g'
  };
  /// Element [k][i] covers cells i .. i + 2^k - 1.
  template <typename R>
  using Levels = std::vector<std::vector<R>>;

  struct Cells {
    std::size_t first, last, level; ///< of the table, to look at
  };
  Cells cells_of(double u_low, double u_high) const;

  double u_low_ = 0, scale_ = 0; ///< where the first inner cell begins, cells per unit
  /// B, C and K grow without bound towards the backward axis: where cells come near it, all are kept times
  /// cos^2(theta / 2), cos^2(theta / 2) and cos(theta / 2).
  bool is_scaled_ = false;
  bool has_jumps_ = false;
  Levels<Row> levels_;
  Levels<BriefRow> brief_levels_;
  std::vector<double> slope_jumps_, weight_jumps_; ///< running sums, cells + 1
};

} // namespace domewarp
