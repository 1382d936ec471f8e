// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/pattern_choice.h"

#include <algorithm>
#include <utility>

#include "domewarp/mesh/weld.h"

namespace domewarp {

namespace {

using Points = std::array<const MappedPoint*, 6>;

/// The edges that patterns can have inside a face, three midlines and three medians; each is judged once, whatever patterns have it.
class Diagonals {
public:
  Diagonals(const Points& points, const EdgeOracle& oracle) : points_(points), oracle_(oracle) {}

  /// Sum of the error bounds of the pattern's inner edges.
  double cost(const SplitPattern& pattern) {
    std::array<double, 3> errors{};
    for (int i = 0; i < pattern.edges; ++i) errors[i] = find(pattern.edge[i]).error;
    std::sort(errors.begin(), errors.end()); // a sum of three must not depend on their order
    return errors[0] + errors[1] + errors[2];
  }

  std::array<std::optional<EdgeBend>, 3> bends(const SplitPattern& pattern) {
    std::array<std::optional<EdgeBend>, 3> all;
    for (int i = 0; i < pattern.edges; ++i) all[i] = find(pattern.edge[i]).bend;
    return all;
  }

private:
  const DiagonalBound& find(const std::array<std::uint8_t, 2>& ends) {
    const unsigned low = std::min(ends[0], ends[1]), high = std::max(ends[0], ends[1]);
    const unsigned slot = low < 3 ? low : low + high - 4; // a median by its corner; 3-4, 3-5, 4-5
    DiagonalBound& bound = bound_[slot];
    if (known_ >> slot & 1) return bound;
    known_ |= 1u << slot;
    const MappedPoint *p = points_[low], *q = points_[high];
    if (precedes(q->eye, p->eye)) std::swap(p, q);
    return bound = oracle_.diagonal(*p, *q);
  }

  const Points& points_;
  const EdgeOracle& oracle_;
  std::array<DiagonalBound, 6> bound_; ///< where known_
  unsigned known_ = 0;
};

/// Compares the edge that tells two patterns of equal cost apart, by its lowest end, then its highest.
bool is_before(const SplitPattern& x, const SplitPattern& y, const Points& points) {
  const auto ends = [&](const SplitPattern& pattern) {
    const auto& telling = pattern.edge[pattern.faces == 3 ? 1 : 0];
    Vec3 low = points[telling[0]]->eye, high = points[telling[1]]->eye;
    if (precedes(high, low)) std::swap(low, high);
    return std::pair(low, high);
  };
  const auto [x_low, x_high] = ends(x);
  const auto [y_low, y_high] = ends(y);
  return precedes(x_low, y_low) || (x_low == y_low && precedes(x_high, y_high));
}

} // namespace

ChosenPattern choose_pattern(unsigned marks, const Points& points, const EdgeOracle& oracle) {
  const PatternChoice& choice = patterns_for(marks);
  if (choice.count == 1) return {choice.pattern[0], {}};
  Diagonals diagonals(points, oracle);
  int best = 0;
  double best_cost = diagonals.cost(choice.pattern[0]);
  for (int i = 1; i < choice.count; ++i) {
    const double c = diagonals.cost(choice.pattern[i]);
    if (c < best_cost || (c == best_cost && is_before(choice.pattern[i], choice.pattern[best], points))) {
      best = i;
      best_cost = c;
    }
  }
  return {choice.pattern[best], diagonals.bends(choice.pattern[best])};
}

} // namespace domewarp
