// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "shapes.h"

namespace domewarp {
namespace {

/// A closed box around the eye at 0.5 px of 4096 rows, whole visible cone.
std::size_t box_triangles(const std::string& expression, Projection projection) {
  SurfaceOptions surface = curve(expression);
  surface.rmax = 1.3;
  RefineOptions options;
  options.projection = projection;
  options.skip.off_picture = false;
  return convert_shape(box_scene(Vec3f(-3.1F, -1.6F, -6.3F), Vec3f(2.7F, 1.9F, 2.2F)), surface, options, {4096, 4096}).report.triangles_out;
}

// Without the other diagonals and the waiting (swap_edges.cpp): 12,813, 12,328 and 8,642; 27,847, 30,328 and 29,519.
TEST(Counts, ABoxNeedsFewerTrianglesThanAnUncertifiedPrototype) {
  EXPECT_LT(box_triangles("1-r^2", Projection::perspective), 10'000u);
  EXPECT_LT(box_triangles("3-sqrt(4+6*r^2)", Projection::perspective), 9'700u);
  EXPECT_LT(box_triangles("1-r", Projection::perspective), 7'200u);
}

TEST(Counts, ABoxNeedsFewerThanThreeTimesALowerBound) { // 8,505, 9,594, 10,520: domewarp-bench mesh
  EXPECT_LT(box_triangles("1-r^2", Projection::orthographic), 3 * 8'505u);
  EXPECT_LT(box_triangles("3-sqrt(4+6*r^2)", Projection::orthographic), 3 * 9'594u);
  EXPECT_LT(box_triangles("1-r", Projection::orthographic), 3 * 10'520u);
}

} // namespace
} // namespace domewarp
