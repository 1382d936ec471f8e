// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "shapes.h"

namespace domewarp {
namespace {

const Raster raster{512, 512};

Scene box() { return box_scene({-3.1f, -1.6f, -6.3f}, {2.7f, 1.9f, 2.2f}); }

RefineOptions splitting_above(double length) {
  RefineOptions options;
  options.criterion_px = 1e-3;
  options.criterion = [length](const MappedPoint& a, const MappedPoint& b) { return glm::length(b.eye - a.eye) > length; };
  return options;
}

/// Longest side of a written triangle, in eye space.
double longest_side(const Scene& scene) {
  double longest = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
      const auto corner = [&](std::size_t i) { return Vec3(source[3 * i], source[3 * i + 1], source[3 * i + 2]); };
      for (std::size_t f = 0; f + 2 < primitive.indices.size(); f += 3)
        for (std::size_t k = 0; k < 3; ++k)
          longest = std::max(longest, glm::length(corner(primitive.indices[f + k]) - corner(primitive.indices[f + (k + 1) % 3])));
    }
  return longest;
}

TEST(Criterion, SplitsWhatItAsksForWithoutACrack) {
  const SurfaceOptions surface = lens(Lens::equidistant, 180);
  const Conversion plain = convert_shape(box(), surface, {}, raster), split = convert_shape(box(), surface, splitting_above(0.3), raster);
  EXPECT_GT(longest_side(plain.scene), 0.6);
  EXPECT_LE(longest_side(split.scene), 0.3 * (1 + 1e-6));
  EXPECT_EQ(split.report.open_edges, 0u);
  EXPECT_EQ(split.report.t_junctions_out, 0u);
  EXPECT_LE(measured_error_px(split, surface, Projection::perspective, raster, 4), 0.5);
}

TEST(Criterion, IsNotAskedAboutEdgesThatAreShortInThePicture) {
  RefineOptions options = splitting_above(0);
  options.criterion_px = 16;
  const Conversion coarse = convert_shape(box(), lens(Lens::equidistant, 180), options, raster);
  options.criterion_px = 8;
  const Conversion fine = convert_shape(box(), lens(Lens::equidistant, 180), options, raster);
  EXPECT_TRUE(coarse.report.limits_hit.empty());
  EXPECT_NEAR(static_cast<double>(fine.report.triangles_out) / static_cast<double>(coarse.report.triangles_out), 4, 1);
}

TEST(Criterion, GivesWayToTheLimitOfTriangles) {
  RefineOptions options = splitting_above(0);
  options.max_triangles = 20000;
  const Conversion conversion = convert_shape(box(), lens(Lens::equidistant, 180), options, raster);
  EXPECT_LE(conversion.report.triangles_out, 20000u);
  EXPECT_FALSE(conversion.report.limits_hit.empty());
}

TEST(Criterion, EndsWhereLightJumps) {
  RefineOptions options;
  // A shadow with an outline that no edge follows, and noise in it.
  options.criterion = [](const MappedPoint& a, const MappedPoint& b) {
    const auto is_lit = [](const Vec3& p) { return std::sin(7 * p.x + 3 * p.y) + std::cos(5 * p.z) > 0; };
    return is_lit(a.eye) != is_lit(b.eye) || is_lit(0.5 * (a.eye + b.eye)) != is_lit(a.eye);
  };
  const Conversion conversion = convert_shape(box(), lens(Lens::equidistant, 180), options, raster);
  EXPECT_TRUE(conversion.report.limits_hit.empty());
  EXPECT_EQ(conversion.report.open_edges, 0u);
  EXPECT_GT(conversion.report.triangles_out, 5000u);
}

} // namespace
} // namespace domewarp
