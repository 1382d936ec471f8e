// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "shapes.h"

namespace domewarp {
namespace {

const Raster raster{1024, 1024};
const std::string thesis_curve_2 = "-r*r*r+r*r+r+1";

Conversion divide(const Scene& scene, double threshold, int max_lod, const std::string& expression = thesis_curve_2) {
  RefineOptions options;
  options.subdivision = Subdivision::isotropic;
  options.isotropic = {threshold, max_lod};
  return convert_shape(scene, curve(expression), options, raster);
}

/// One triangle straight ahead, its longest image edge about 1.1 units.
const Scene& triangle() {
  static const Scene scene = triangles_scene({{-1, -1, -2}, {1, -1, -2}, {0, 1, -2}});
  return scene;
}

TEST(Isotropic, CountsPointsAsTheThesisDoes) {
  // Every threshold is exceeded at 1e-9, so level L has (4^L - 1) / 3 divisions behind it.
  for (const int lod : {0, 1, 2, 5}) {
    const IsotropicReport report = divide(triangle(), 1e-9, lod).report.isotropic;
    const auto divisions = static_cast<std::size_t>(std::lround((std::pow(4, lod) - 1) / 3));
    EXPECT_EQ(report.divisions, divisions) << lod;
    EXPECT_EQ(report.points, 3 + 12 * divisions) << lod;
    EXPECT_EQ(report.points_computed, 3 + 3 * divisions) << lod;
  }
}

TEST(Isotropic, StopsWhenTheLongestImageEdgeIsShortEnough) {
  const Conversion conversion = divide(triangle(), 0.3, 9);
  EXPECT_GT(conversion.report.triangles_out, 4u);
  const Primitive& primitive = conversion.scene.meshes[0].primitives[0];
  for (std::size_t i = 0; i < primitive.indices.size(); ++i) {
    const Vec3 a(primitive.positions[primitive.indices[i]]), b(primitive.positions[primitive.indices[i % 3 == 2 ? i - 2 : i + 1]]);
    EXPECT_LE(glm::length(Vec2(a) / -a.z - Vec2(b) / -b.z), 0.3 * (1 + 1e-6));
  }
}

TEST(Isotropic, LosesATriangleWhoseCornersAreAllOutside) {
  // Erratum 9, kept: the wall fills the view, but no corner of it is seen.
  const Scene wall = triangles_scene({{-100, -90, 1}, {100, -90, 1}, {0, 200, 1}});
  const Conversion conversion = divide(wall, 0.1, 5);
  EXPECT_EQ(conversion.report.triangles_out, 0u);
  EXPECT_EQ(conversion.report.isotropic.invisible, 1u);
}

TEST(Isotropic, LeavesDifferentDepthsOnBothSidesOfAnEdge) {
  // The right triangle alone is large; its neighbour across x = 0 stays whole, so the shared edge gets points on one side.
  const Scene pair = triangles_scene({{0, -0.5f, -2}, {2, 0, -2}, {0, 0.5f, -2}, {0, -0.5f, -2}, {0, 0.5f, -2}, {-0.2f, 0, -2}});
  const Conversion conversion = divide(pair, 0.9, 1);
  EXPECT_EQ(conversion.report.triangles_out, 5u);
  EXPECT_EQ(conversion.report.isotropic.points, 6u + 12u);
}

TEST(Isotropic, GivesTheSameForAnyNumberOfThreads) {
  const Scene box = box_scene({-3.1f, -1.6f, -6.3f}, {2.7f, 1.9f, 2.2f});
  const auto positions = [&](int threads) {
    const ThreadLimit limit(threads);
    return divide(box, 0.05, 6).scene.meshes[0].primitives[0].positions;
  };
  EXPECT_EQ(positions(1), positions(4));
}

TEST(Isotropic, RefusesWhatCannotBe) {
  EXPECT_THROW(divide(triangle(), 0, 3), Error);
  EXPECT_THROW(divide(triangle(), 0.1, 13), Error);
}

} // namespace
} // namespace domewarp
