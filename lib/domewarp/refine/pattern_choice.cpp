// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/pattern_choice.h"

#include <algorithm>
#include <utility>

#include "domewarp/mesh/weld.h"

namespace domewarp {

namespace {

using Points = std::array<const MappedPoint*, 6>;

double cost(const SplitPattern& pattern, const Points& points, const EdgeOracle& oracle) {
  std::array<double, 3> errors{};
  for (int i = 0; i < pattern.edges; ++i) {
    const MappedPoint *p = points[pattern.edge[i][0]], *q = points[pattern.edge[i][1]];
    if (precedes(q->eye, p->eye)) std::swap(p, q);
    errors[i] = oracle.diagonal_error(*p, *q);
  }
  std::sort(errors.begin(), errors.end()); // a sum of three must not depend on their order
  return errors[0] + errors[1] + errors[2];
}

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

const SplitPattern& choose_pattern(unsigned marks, const Points& points, const EdgeOracle& oracle) {
  const PatternChoice& choice = patterns_for(marks);
  if (choice.count == 1) return choice.pattern[0];
  int best = 0;
  double best_cost = cost(choice.pattern[0], points, oracle);
  for (int i = 1; i < choice.count; ++i) {
    const double c = cost(choice.pattern[i], points, oracle);
    if (c < best_cost || (c == best_cost && is_before(choice.pattern[i], choice.pattern[best], points))) {
      best = i;
      best_cost = c;
    }
  }
  return choice.pattern[best];
}

} // namespace domewarp
