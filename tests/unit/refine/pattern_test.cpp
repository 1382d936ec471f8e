// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "domewarp/core/vectors.h"
#include "domewarp/refine/split_patterns.h"

namespace domewarp {
namespace {

TEST(SplitPatterns, CoverTheTriangleOnceWithCounterClockwiseFaces) {
  const std::array<Vec2, 6> at = {Vec2(0, 0), Vec2(4, 0), Vec2(0, 4), Vec2(2, 0), Vec2(2, 2), Vec2(0, 2)};
  for (unsigned marks = 1; marks < 8; ++marks) {
    const PatternChoice& choice = patterns_for(marks);
    EXPECT_EQ(choice.count, marks == 7 ? 4 : __builtin_popcount(marks));
    for (int i = 0; i < choice.count; ++i) {
      double area = 0;
      for (int f = 0; f < choice.pattern[i].faces; ++f) {
        const auto& face = choice.pattern[i].face[f];
        const Vec2 u = at[face[1]] - at[face[0]], v = at[face[2]] - at[face[0]];
        const double twice = u.x * v.y - u.y * v.x;
        EXPECT_GT(twice, 0) << "marks " << marks << " pattern " << i << " face " << f;
        area += twice / 2;
        for (const int corner : face) EXPECT_TRUE(corner < 3 || marks >> (corner - 3) & 1u);
      }
      EXPECT_DOUBLE_EQ(area, 8) << "marks " << marks << " pattern " << i;
    }
  }
}

} // namespace
} // namespace domewarp
