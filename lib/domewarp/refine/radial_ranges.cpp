// SPDX-License-Identifier: Apache-2.0
//
// R' and R'' over a cell are hulls of interval enclosures over parts of it, halved until they are narrow. B and C have
// a removable singularity on the axis, where their quotients cancel. Both follow from their value at the cell's start:
//   (B sin^2)' = R'' sin cos - 2 R' sin^2,   (C sin^2)' = (R'' + R) sin,   K' = C,
// so with l = sin^2(theta_0) / sin^2(theta), up to 90 degrees,
//   B = l B_0 + (1 - l) R''/2 - 2 R' [0, theta - theta_0],   C = l C_0 + (1 - l) (R'' + R) / (cos + cos_0),
// which needs no value at the start on the axis, where l = 0.
#include "domewarp/refine/radial_ranges.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "domewarp/core/parallel.h"
#include "domewarp/core/rounding.h"
#include "domewarp/profile/half_angle.h"
#include "domewarp/transform/continuation.h"
#include "domewarp/transform/image_map.h"
#include "domewarp/transform/weight.h"

namespace domewarp {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double right_angle = std::numbers::pi / 2;
constexpr double near_pole = 0.8; ///< half-angle index, 152 degrees

double angle_at(double u) { return 2 * std::atan2(u, 1 - u); }
double index_of(double theta) { return half_angle_index(std::sin(theta), std::cos(theta), 1); }

Interval unite(const Interval& a, const Interval& b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }
double width(const Interval& a) { return a.hi - a.lo; }
double magnitude(const Interval& a) { return std::max(std::abs(a.lo), std::abs(a.hi)); }

/// R over a range of angles within a branch or beyond one of its ends (transform/continuation.h).
class ContinuedRadius {
public:
  ContinuedRadius(const Surface& surface, std::size_t branch)
      : surface_(surface), branch_(branch), range_(surface.branches()[branch]), before_(surface, branch, false), after_(surface, branch, true) {}

  RadialEnclosure enclose(double low, double high) const {
    if (high <= range_.theta_low) return before_.enclose(low, high);
    if (low >= range_.theta_high) return after_.enclose(low, high);
    RadialEnclosure all = surface_.enclose(branch_, std::max(low, range_.theta_low), std::min(high, range_.theta_high));
    if (low < range_.theta_low) include(all, before_.enclose(low, range_.theta_low));
    if (high > range_.theta_high) include(all, after_.enclose(range_.theta_high, high));
    return all;
  }

private:
  static void include(RadialEnclosure& all, const RadialEnclosure& part) {
    all = {unite(all.r, part.r), unite(all.dr, part.dr), unite(all.d2r, part.d2r)};
  }

  const Surface& surface_;
  std::size_t branch_;
  const Branch& range_;
  Continuation before_, after_;
};

/// Hull of the enclosures over the parts of one cell.
struct Smooth {
  Interval r{infinity, -infinity}, dr{infinity, -infinity}, d2r{infinity, -infinity};
  double jump = 0; ///< change of R' over parts too narrow to matter in which R'' has no bound
};

class CellEncloser {
public:
  explicit CellEncloser(const ContinuedRadius& radius) : radius_(radius) {}

  Smooth enclose(double low, double high) {
    sum_ = {};
    budget_ = 4000;
    add(low, high, 0);
    if (sum_.d2r.lo > sum_.d2r.hi) sum_.d2r = Interval(0);
    if (std::isinf(sum_.jump)) { // a fold: no length of edge has a bound here
      sum_.d2r = entire(Regularity::unknown);
      sum_.jump = 0;
    }
    return sum_;
  }

private:
  // Narrower than this nothing shows: 1e-11 of an image's width.
  static constexpr double narrowest = 1e-11;
  /// A vertical tangent leaves R' continuous while enclosures of R'' widen without bound: half their size is narrow
  /// enough there.
  static constexpr double unnoticed_jump = 5e-7;

  void add(double low, double high, int depth) {
    const RadialEnclosure e = radius_.enclose(low, high);
    const bool is_bounded_here = is_bounded(e.d2r) && is_bounded(e.dr);
    const double size = magnitude(e.d2r) + magnitude(e.dr) + magnitude(e.r);
    const bool is_narrow = is_bounded_here && width(e.d2r) <= (depth < 7 ? 0.03 : 0.5) * size;
    const bool is_small_jump = width(e.dr) <= unnoticed_jump * (magnitude(e.dr) + magnitude(e.r));
    const double middle = 0.5 * (low + high);
    const bool can_split = high - low > narrowest && middle > low && middle < high && budget_ > 0;
    if (!is_narrow && !is_small_jump && can_split) {
      --budget_;
      add(low, middle, depth + 1);
      add(middle, high, depth + 1);
      return;
    }
    sum_.r = unite(sum_.r, e.r);
    sum_.dr = unite(sum_.dr, e.dr);
    if (is_narrow || (is_bounded_here && !is_small_jump))
      sum_.d2r = unite(sum_.d2r, e.d2r);
    else
      sum_.jump += is_small_jump || high - low <= narrowest ? width(e.dr) : infinity;
  }

  const ContinuedRadius& radius_;
  Smooth sum_;
  int budget_ = 0;
};

struct Quotients {
  Interval across, twist, factor;
};

/// B, C and K at one angle off the axis.
Quotients quotients_at(const ContinuedRadius& radius, double theta) {
  const RadialEnclosure e = radius.enclose(theta, theta);
  const Interval angle(theta), s = sin(angle), c = cos(angle), s2 = power(s, 2);
  return {(e.dr * s * c - e.r) / s2, (e.dr * s - e.r * c) / s2, e.r / s};
}

Interval fraction(const Interval& part, const Interval& from, const Interval& to) {
  return part * from + (Interval(1) - part) * to;
}

Quotients before_right_angle(const Smooth& cell, const Quotients& start, double low, double high) {
  const double step = high - low, sine = std::sin(low) / std::sin(high);
  const double least = low > 0 ? sine * sine * (1 - 1e-14) : 0;
  const Interval jump(-cell.jump, cell.jump), c = cos(Interval(low, high)), c0 = cos(Interval(low));
  const auto over_share = [&](const Interval& from, const Interval& to) {
    const Interval nearest = fraction(Interval(least), from, to);
    return low > 0 ? unite(from, nearest) : nearest;
  };
  Quotients q;
  q.across = over_share(start.across, Interval(0.5) * cell.d2r) - Interval(2) * cell.dr * Interval(0, step);
  q.twist = over_share(start.twist, (cell.d2r + cell.r) / (c + c0));
  if (cell.jump > 0) { // R' rises by that much at once somewhere: sin cos / sin^2 and sin / sin^2 of it
    const Interval s = sin(Interval(low, high));
    q.across = q.across + jump / s;
    q.twist = q.twist + jump / s;
  }
  q.factor = start.factor + q.twist * Interval(0, step);
  return q;
}

/// The same beyond it. Scaled, cos^2(theta / 2) / sin^2(theta) = 1 / (4 sin^2(theta / 2)) takes the pole away.
Quotients beyond_right_angle(const Smooth& cell, const Quotients& start, double low, double high, bool is_scaled) {
  const Interval angle(low, high), step(0, high - low), s = sin(angle), s02 = power(sin(Interval(low)), 2);
  const Interval jump(-cell.jump, cell.jump), divisor = is_scaled ? Interval(2) * sin(Interval(0.5 * low, 0.5 * high)) : s, bottom = power(divisor, 2);
  Quotients q;
  q.across = (start.across * s02 + step * (cell.d2r * s * cos(angle) - Interval(2) * cell.dr * power(s, 2)) + jump * s) / bottom;
  q.twist = (start.twist * s02 + step * ((cell.d2r + cell.r) * s) + jump * s) / bottom;
  q.factor = cell.r / divisor;
  return q;
}

Quotients scaled(const Quotients& q, double low, double high) {
  const Interval half = cos(Interval(0.5 * low, 0.5 * high)), half2 = power(half, 2);
  return {q.across * half2, q.twist * half2, q.factor * half};
}

struct Weights {
  Interval g, slope;
  double jump = 0;
};

/// g = b^(-1/4), b = (q^2 + e^2) / (1 + q^2 e^2), q = |R'| / mean: falls as q grows (transform/weight.h).
Weights weights_of(const Smooth& cell, double mean) {
  const Interval size = abs(cell.dr);
  constexpr double rounding = 1e-13;
  Weights w;
  w.g = {weight(size.hi, mean) * (1 - rounding), weight(size.lo, mean) * (1 + rounding)};
  w.slope = Interval(0);
  if (std::isinf(mean)) return w;
  constexpr double e2 = BranchMap::weight_epsilon * BranchMap::weight_epsilon;
  const Interval q = cell.dr / Interval(mean), q2 = power(q, 2), bottom = Interval(1) + Interval(e2) * q2;
  const Interval b = (q2 + Interval(e2)) / bottom;
  const Interval rate = Interval(-0.5 * (1 - e2 * e2) / mean) * w.g / b * q / power(bottom, 2); // dg/dR'
  w.slope = rate * cell.d2r;
  w.jump = magnitude(rate) * cell.jump;
  return w;
}

} // namespace

namespace {

/// Bounds of one range of angles, before they are made rows of the table.
struct Cell {
  Interval along, across, twist, slope, factor, weight, weight_slope;
  double slope_jump = 0, weight_jump = 0;
};

Cell make_cell(const ContinuedRadius& radius, double mean, double low, double high, bool is_scaled) {
  const Smooth smooth = CellEncloser(radius).enclose(low, high);
  Quotients start;
  if (low > 0)
    start = quotients_at(radius, low);
  else
    start.factor = radius.enclose(0, 0).dr;
  Quotients q = high <= right_angle ? before_right_angle(smooth, start, low, high) : beyond_right_angle(smooth, start, low, high, is_scaled);
  if (is_scaled && high <= right_angle) q = scaled(q, low, high);
  const Weights w = weights_of(smooth, mean);
  return {smooth.d2r, q.across, q.twist, smooth.dr, q.factor, w.g, w.slope, smooth.jump, w.jump};
}

/// @param last angle where the cell ends, for what is scaled
std::array<float, 8> brief_of(const Cell& cell, bool is_scaled, double last) {
  const double half = std::cos(0.5 * last), root = is_scaled ? (1 + 1e-12) / half : 1, square = root * root; // secants
  const double bend = std::max(magnitude(cell.along), magnitude(cell.across) * square), twist = magnitude(cell.twist) * square;
  const bool jumps = cell.slope_jump > 0 || cell.weight_jump > 0;
  return {rounded_up(jumps ? infinity : std::sqrt(bend * bend + twist * twist) * (1 + 1e-12)),
          rounded_up(std::max(magnitude(cell.slope), magnitude(cell.factor) * root)),
          rounded_up((1 + 1e-12) / cell.weight.lo),
          rounded_up(-cell.weight_slope.lo),
          rounded_up(cell.weight_slope.hi)};
}

/// Of the rows in levels[0].
template <typename Row>
void add_levels(std::vector<std::vector<Row>>& levels) {
  const std::size_t cells = levels[0].size();
  for (std::size_t span = 2; span <= cells; span *= 2) {
    const std::vector<Row>& finer = levels.back();
    std::vector<Row> level(cells - span + 1);
    for (std::size_t i = 0; i < level.size(); ++i)
      for (std::size_t k = 0; k < level[i].bound.size(); ++k) level[i].bound[k] = std::max(finer[i].bound[k], finer[i + span / 2].bound[k]);
    levels.push_back(std::move(level));
  }
}

const Cell unknown{entire(Regularity::unknown), {0}, {0}, {0}, {0}, {1}, {0}, 0, 0};

} // namespace

RadialRanges::RadialRanges(const Surface& surface, std::size_t branch, double theta_low, double theta_high) {
  u_low_ = theta_low == 0 ? 0 : index_of(theta_low);
  const double u_high = theta_high >= std::numbers::pi ? 1 : index_of(theta_high);
  scale_ = inner_cells / (u_high - u_low_);
  is_scaled_ = u_high + margin / scale_ > near_pole;
  const double mean = mean_slope(surface, branch);
  const ContinuedRadius radius(surface, branch);
  const Branch& range = surface.branches()[branch];
  slope_jumps_.assign(cells + 1, 0);
  weight_jumps_.assign(cells + 1, 0);
  levels_.emplace_back(cells);
  brief_levels_.emplace_back(cells);
  parallel_each(cells, 8, [&](std::size_t i) {
    constexpr double rounding = 1e-13;
    const auto start_of = [&](std::size_t cell) {
      if (cell == margin) return theta_low;
      if (cell == margin + inner_cells) return theta_high;
      return angle_at(std::clamp(u_low_ + (static_cast<double>(cell) - margin) / scale_, 0.0, 1.0));
    };
    const double first = std::max(0.0, start_of(i) - (i == margin ? 0 : rounding));
    const double last = std::min(std::numbers::pi, start_of(i + 1) + (i + 1 == margin + inner_cells ? 0 : rounding));
    const bool is_outermost = (i == 0 && first > 0) || (i + 1 == cells && last < std::numbers::pi);
    const bool has_pole = i < margin && first <= 0; // K = R / sin(theta), and R is not 0 there
    Cell cell = is_outermost || has_pole ? unknown : make_cell(radius, mean, first, last, is_scaled_);
    for (const bool is_high : {false, true}) {
      const double end = is_high ? range.theta_high : range.theta_low;
      if (is_high ? last <= end : first >= end) continue;
      const double g = weight(surface.radial(branch, end).dr, mean); // beyond an end BranchMap keeps the end's weight
      cell.weight = unite(cell.weight, Interval(g * (1 - rounding), g * (1 + rounding)));
      cell.weight_slope = unite(cell.weight_slope, Interval(0));
    }
    const std::array<Interval, quantities> all{cell.along, cell.across, cell.twist, cell.slope, cell.factor, cell.weight, cell.weight_slope};
    for (int k = 0; k < quantities; ++k) {
      levels_[0][i].bound[k] = rounded_up(-all[k].lo);
      levels_[0][i].bound[half + k] = rounded_up(all[k].hi);
    }
    brief_levels_[0][i].bound = brief_of(cell, is_scaled_, last);
    slope_jumps_[i + 1] = cell.slope_jump;
    weight_jumps_[i + 1] = cell.weight_jump;
  });
  for (std::size_t i = 0; i < cells; ++i) {
    slope_jumps_[i + 1] += slope_jumps_[i];
    weight_jumps_[i + 1] += weight_jumps_[i];
  }
  has_jumps_ = slope_jumps_.back() > 0 || weight_jumps_.back() > 0;
  add_levels(levels_);
  add_levels(brief_levels_);
}

RadialRanges::Cells RadialRanges::cells_of(double u_low, double u_high) const {
  const auto cell = [&](double u) { return static_cast<std::size_t>(std::clamp(margin + (u - u_low_) * scale_, 0.0, cells - 1.0)); };
  const std::size_t first = cell(u_low), last = std::max(first, cell(u_high)); // rounding may have swapped them
  return {first, last, static_cast<std::size_t>(std::bit_width(last - first + 1) - 1)};
}

BriefRange RadialRanges::brief(double u_low, double u_high) const {
  const auto [first, last, level] = cells_of(u_low, u_high);
  const std::vector<BriefRow>& rows = brief_levels_[level];
  const BriefRow &left = rows[first], &right = rows[last + 1 - (std::size_t{1} << level)];
  const auto most = [&](std::size_t k) { return static_cast<double>(std::max(left.bound[k], right.bound[k])); };
  return {most(0), most(1), most(2), {-most(3), most(4)}};
}

RadialRange RadialRanges::over(double u_low, double u_high) const {
  const auto [first, last, level] = cells_of(u_low, u_high);
  const std::vector<Row>& rows = levels_[level];
  const Row &left = rows[first], &right = rows[last + 1 - (std::size_t{1} << level)];
  Row all;
  for (std::size_t k = 0; k < 2 * half; ++k) all.bound[k] = std::max(left.bound[k], right.bound[k]);
  const auto range = [&](std::size_t k) -> Range { return {-static_cast<double>(all.bound[k]), static_cast<double>(all.bound[half + k])}; };
  RadialRange r{range(0), range(1), range(2), range(3), range(4), range(5), range(6)};
  if (is_scaled_) {
    // cos^2(theta / 2) falls with u.
    const auto secant2 = [](double u) { return ((1 - u) * (1 - u) + u * u) / ((1 - u) * (1 - u)); };
    const Range square{secant2(u_low), secant2(u_high)}, root{std::sqrt(square.low), std::sqrt(square.high)};
    const auto unscaled = [](const Range& a, const Range& by) -> Range {
      return {a.low * (a.low < 0 ? by.high : by.low), a.high * (a.high > 0 ? by.high : by.low)};
    };
    r.across = unscaled(r.across, square);
    r.twist = unscaled(r.twist, square);
    r.factor = unscaled(r.factor, root);
  }
  if (has_jumps_) {
    r.slope_jump = slope_jumps_[last + 1] - slope_jumps_[first];
    r.weight_jump = weight_jumps_[last + 1] - weight_jumps_[first];
  }
  return r;
}

} // namespace domewarp
