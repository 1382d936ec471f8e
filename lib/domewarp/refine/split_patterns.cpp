// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/split_patterns.h"

namespace domewarp {

namespace {

using Index = std::uint8_t;

constexpr Index corner(int k) { return static_cast<Index>(k % 3); }
constexpr Index middle(int k) { return static_cast<Index>(3 + k % 3); } // of the edge from corner k to k + 1

constexpr SplitPattern one_mark(int k) {
  const Index m = middle(k), opposite = corner(k + 2);
  return {2, {{{corner(k), m, opposite}, {m, corner(k + 1), opposite}}}, 1, {{{m, opposite}}}};
}

/// `k` is the edge without a mark.
constexpr SplitPattern two_marks(int k, bool first_diagonal) {
  const Index a = corner(k), b = corner(k + 1), c = corner(k + 2), p = middle(k + 1), q = middle(k + 2);
  if (first_diagonal) return {3, {{{p, c, q}, {a, b, p}, {a, p, q}}}, 2, {{{p, q}, {a, p}}}};
  return {3, {{{p, c, q}, {a, b, q}, {b, p, q}}}, 2, {{{p, q}, {b, q}}}};
}

constexpr SplitPattern red() {
  return {4, {{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}}, 3, {{{3, 4}, {4, 5}, {5, 3}}}};
}

/// A median from corner k and the two edges from its foot to the other split points.
constexpr SplitPattern median(int k) {
  const Index a = corner(k), b = corner(k + 1), c = corner(k + 2), ab = middle(k), bc = middle(k + 1), ca = middle(k + 2);
  return {4, {{{a, ab, bc}, {ab, b, bc}, {a, bc, ca}, {ca, bc, c}}}, 3, {{{a, bc}, {ab, bc}, {bc, ca}}}};
}

constexpr std::array<PatternChoice, 8> table = {{
    {},
    {1, {one_mark(0)}},
    {1, {one_mark(1)}},
    {2, {two_marks(2, true), two_marks(2, false)}},
    {1, {one_mark(2)}},
    {2, {two_marks(1, true), two_marks(1, false)}},
    {2, {two_marks(0, true), two_marks(0, false)}},
    {4, {red(), median(0), median(1), median(2)}},
}};

} // namespace

const PatternChoice& patterns_for(unsigned marks) { return table[marks]; }

} // namespace domewarp
