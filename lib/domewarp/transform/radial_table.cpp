// SPDX-License-Identifier: Apache-2.0
#include "domewarp/transform/radial_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "domewarp/transform/weight.h"

namespace domewarp {

namespace {

using Segment = RadialTable::Segment;
using Grading = RadialTable::Grading;

constexpr int degree = RadialTable::degree;
constexpr int nodes = degree + 1;

constexpr double allowed_error = 1e-10; // of R: what the map promises
constexpr double goal = 1e-13;          // costs one halving more than the promise, and lets round trips close
constexpr double index_rounding = 4e-16; // of u, from a direction: what it moves R by, no table can be exact to
constexpr double least_share = 0.1;     // of the error of R / u counts even at u = 0: K must hold near the axis
constexpr double weight_goal = 1e-9;
constexpr int level_limit = 10; // of halvings
constexpr std::size_t segment_limit = 1024;
constexpr double fold_margin = 1e-4; // in the root: nearer, u's own rounding moves R by more than the promise

// Place in the segment, 0 to 1, and back.
double position(const Segment& segment, double u) {
  switch (segment.grading) {
  case Grading::to_low: return std::sqrt(std::max(0.0, (u - segment.u_low) * segment.scale));
  case Grading::to_high: return 1 - std::sqrt(std::max(0.0, (segment.u_high - u) * segment.scale));
  default: return (u - segment.u_low) * segment.scale;
  }
}

double index_at(const Segment& segment, double v) {
  const double width = segment.u_high - segment.u_low;
  switch (segment.grading) {
  case Grading::to_low: return segment.u_low + width * v * v;
  case Grading::to_high: return segment.u_high - width * (1 - v) * (1 - v);
  default: return segment.u_low + width * v;
  }
}

bool is_beside_fold(const Segment& segment, double v) {
  return (segment.grading == Grading::to_low && v < fold_margin) ||
         (segment.grading == Grading::to_high && v > 1 - fold_margin);
}

struct Sample {
  double u, ratio, g;
  double noise; // of R
};

class Sampler {
public:
  Sampler(const Surface& surface, std::size_t branch)
      : surface_(surface), branch_(branch), mean_(mean_slope(surface, branch)) {}

  Sample at(double u) const {
    const double n = u, o = 1 - u, square = n * n + o * o;
    const double s = 2 * n * o / square, c = (o - n) * (o + n) / square;
    const RadialJet jet = surface_.radial(branch_, std::atan2(s, c));
    return {u, u > 0 ? jet.r / u : 2 * jet.dr, weight(jet.dr, mean_), index_rounding * std::abs(jet.dr) * 2 / square};
  }

private:
  const Surface& surface_;
  std::size_t branch_;
  double mean_;
};

// Chebyshev nodes in [-1, 1] and, for each power, the weights that turn values there into its coefficient.
struct Basis {
  std::array<double, nodes> x{};
  std::array<std::array<double, nodes>, nodes> inverse{};
};

Basis make_basis() {
  Basis basis;
  std::array<std::array<double, nodes>, nodes> chebyshev{}; // coefficients of T_k
  chebyshev[0][0] = 1;
  chebyshev[1][1] = 1;
  for (int k = 2; k < nodes; ++k)
    for (int power = 0; power < nodes; ++power)
      chebyshev[k][power] = (power > 0 ? 2 * chebyshev[k - 1][power - 1] : 0) - chebyshev[k - 2][power];
  for (int j = 0; j < nodes; ++j) {
    const double angle = std::numbers::pi * (j + 0.5) / nodes;
    basis.x[j] = std::cos(angle);
    for (int k = 0; k < nodes; ++k)
      for (int power = 0; power < nodes; ++power)
        basis.inverse[power][j] += (k == 0 ? 1.0 : 2.0) / nodes * std::cos(k * angle) * chebyshev[k][power];
  }
  return basis;
}

RadialTable::Piece fit_piece(const Sampler& sampler, const Segment& segment, double low, double width) {
  static const Basis basis = make_basis();
  std::array<Sample, nodes> samples;
  for (int j = 0; j < nodes; ++j) samples[j] = sampler.at(index_at(segment, low + 0.5 * width * (1 + basis.x[j])));
  RadialTable::Piece piece{low, 2 / width};
  double* coefficient = piece.coefficients.data();
  for (int power = degree; power >= 0; --power) {
    double ratio = 0, g = 0;
    for (int j = 0; j < nodes; ++j) {
      ratio += basis.inverse[power][j] * samples[j].ratio;
      g += basis.inverse[power][j] * samples[j].g;
    }
    *coefficient++ = ratio;
    *coefficient++ = g;
  }
  return piece;
}

Vec2 evaluate_piece(const RadialTable::Piece& piece, double x) {
  const double* const c = piece.coefficients.data();
  double ratio = c[0], g = c[1];
  for (int i = 1; i < nodes; ++i) {
    ratio = ratio * x + c[2 * i];
    g = g * x + c[2 * i + 1];
  }
  return {ratio, g};
}

struct PieceError {
  double radius = 0;
  bool met = true; ///< the goals
};

// The error of a polynomial that interpolates peaks between its nodes and at its ends.
// @param thorough false: stop at the first place that misses a goal
PieceError measure_piece(const Sampler& sampler, const Segment& segment, const RadialTable::Piece& piece, double size, bool thorough) {
  PieceError error;
  for (int j = 0; j <= nodes && (error.met || thorough); ++j) {
    const double x = -std::cos(std::numbers::pi * j / nodes), v = piece.low + (1 + x) / piece.scale;
    if (is_beside_fold(segment, v)) continue;
    const Sample sample = sampler.at(index_at(segment, v));
    const Vec2 value = evaluate_piece(piece, x);
    const double radius = std::abs(value.x - sample.ratio) * std::max(sample.u, least_share);
    error.radius = std::max(error.radius, radius);
    error.met = error.met && radius <= goal * size + sample.noise;
    // g jumps at a kink, and rounding may put the segment's very end beyond it.
    if (v > 0 && v < 1) error.met = error.met && std::abs(value.y / sample.g - 1) <= weight_goal;
  }
  return error;
}

// Halves one segment until its pieces are exact, from left to right.
class SegmentBuilder {
public:
  SegmentBuilder(RadialTable& table, const Sampler& sampler, const Segment& segment, double size)
      : table_(table), sampler_(sampler), segment_(segment), size_(size) {}

  bool build() {
    const std::size_t first = table_.pieces.size();
    if (!add(0, 1, 0)) return false;
    segment_.cells = std::ldexp(1.0, deepest_);
    segment_.first_cell = table_.cells.size();
    for (std::size_t i = first; i < table_.pieces.size(); ++i) {
      const auto cells = static_cast<std::size_t>(segment_.cells * 2 / table_.pieces[i].scale);
      table_.cells.insert(table_.cells.end(), cells, static_cast<std::uint32_t>(i));
    }
    table_.segments.push_back(segment_);
    return true;
  }

private:
  bool add(double low, double width, int level) {
    const RadialTable::Piece piece = fit_piece(sampler_, segment_, low, width);
    const bool last = level == level_limit;
    const PieceError error = measure_piece(sampler_, segment_, piece, size_, last);
    if (!error.met && !last) return add(low, 0.5 * width, level + 1) && add(low + 0.5 * width, 0.5 * width, level + 1);
    table_.max_error = std::max(table_.max_error, error.radius);
    table_.pieces.push_back(piece);
    deepest_ = std::max(deepest_, level);
    return error.radius <= allowed_error;
  }

  RadialTable& table_;
  const Sampler& sampler_;
  Segment segment_;
  double size_;
  int deepest_ = 0;
};

// Ends of smooth stretches in u. A branch between two folds is cut in its middle, so that each part grades to one.
std::vector<double> stretch_ends(const Surface& surface, std::size_t branch) {
  const Branch& range = surface.branches()[branch];
  const auto index = [](double theta) { return half_angle_index(std::sin(theta), std::cos(theta), 1); };
  std::vector<double> ends{range.theta_low == 0 ? 0 : index(range.theta_low)};
  for (const double theta : surface.joints(branch)) ends.push_back(index(theta));
  ends.push_back(range.theta_high >= std::numbers::pi ? 1 : index(range.theta_high));
  if (ends.size() == 2 && range.fold_low && range.fold_high) ends.insert(ends.begin() + 1, 0.5 * (ends[0] + ends[1]));
  return ends;
}

} // namespace

RadialTable make_radial_table(const Surface& surface, std::size_t branch) {
  const Branch& range = surface.branches()[branch];
  RadialTable table;
  // R falls to 0 on the backward axis only on surfaces behind the eye; K = R / sin(theta) would be lost in rounding.
  const bool closes_behind = range.theta_high >= std::numbers::pi && range.radius_high == 0;
  const std::vector<double> ends = stretch_ends(surface, branch);
  if (closes_behind || ends.size() > segment_limit) {
    table.max_error = std::numeric_limits<double>::infinity();
    return table;
  }
  const Sampler sampler(surface, branch);
  const double size = std::max({1.0, range.radius_low, range.radius_high});
  table.qualifies = true;
  for (std::size_t i = 0; i + 1 < ends.size() && table.qualifies; ++i) {
    Segment segment{ends[i], ends[i + 1], 1 / (ends[i + 1] - ends[i])};
    if (i == 0 && range.fold_low) segment.grading = Grading::to_low;
    if (i + 2 == ends.size() && range.fold_high) segment.grading = Grading::to_high;
    table.qualifies = std::isfinite(segment.scale) && SegmentBuilder(table, sampler, segment, size).build();
  }
  return table;
}

TableValue look_up(const RadialTable& table, double u) {
  const Segment* segment = table.segments.data();
  if (table.segments.size() > 1) {
    const auto next = std::upper_bound(table.segments.begin() + 1, table.segments.end(), u,
                                       [](double value, const Segment& other) { return value < other.u_low; });
    segment = &*(next - 1);
  }
  const double v = position(*segment, u), place = std::clamp(v, 0.0, 1.0);
  const auto cell = static_cast<std::size_t>(std::min(place * segment->cells, segment->cells - 1));
  const RadialTable::Piece& piece = table.pieces[table.cells[segment->first_cell + cell]];
  const Vec2 value = evaluate_piece(piece, (place - piece.low) * piece.scale - 1);
  return {value.x, value.y, !is_beside_fold(*segment, v)};
}

} // namespace domewarp
