// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "shapes.h"

namespace domewarp {
namespace {

Scene lines_scene(const std::vector<Vec3f>& ends) {
  Scene scene = triangles_scene(ends);
  Primitive& primitive = scene.meshes[0].primitives[0];
  primitive.topology = Topology::lines;
  primitive.indices.resize(ends.size() / 2 * 2);
  return scene;
}

const Primitive& only_primitive(const Conversion& conversion) { return conversion.scene.meshes.at(0).primitives.at(0); }

Vec3 source_at(const Primitive& primitive, std::uint32_t vertex) {
  const std::vector<float>& values = primitive.attributes.back().values;
  return {values[3 * vertex], values[3 * vertex + 1], values[3 * vertex + 2]};
}

using Position = std::array<float, 3>;

std::set<Position> positions_of(const Primitive& primitive) {
  std::set<Position> positions;
  for (const Vec3f& p : primitive.positions) positions.insert({p.x, p.y, p.z});
  return positions;
}

/// Largest distance in pixels between where a line drawn from the written vertices shows a point and where the lens
/// shows its source.
double largest_error_px(const Primitive& warped, const Raster& raster) {
  double worst = 0;
  for (std::size_t i = 0; i + 1 < warped.indices.size(); i += 2)
    for (int k = 0; k <= 16; ++k) {
      const double t = k / 16.0;
      const std::uint32_t a = warped.indices[i], b = warped.indices[i + 1];
      const Vec3 drawn = Vec3(warped.positions[a]) * (1 - t) + Vec3(warped.positions[b]) * t;
      const Vec3 eye = source_at(warped, a) * (1 - t) + source_at(warped, b) * t;
      const double theta = std::atan2(std::hypot(eye.x, eye.y), -eye.z), radius = theta / (M_PI / 2);
      const Vec2 exact = Vec2(eye) / std::hypot(eye.x, eye.y) * radius;
      worst = std::max(worst, glm::length(Vec2(drawn) / -drawn.z - exact) / pixel_size(raster));
    }
  return worst;
}

TEST(Lines, StayWithinTheToleranceEverywhere) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-10, 10);
  std::vector<Vec3f> ends;
  for (int i = 0; i < 200; ++i) ends.push_back({place(random), place(random), place(random)});
  const Conversion conversion = convert_shape(lines_scene(ends), lens(Lens::equidistant, 180));
  const Primitive& warped = only_primitive(conversion);
  EXPECT_EQ(warped.topology, Topology::lines);
  EXPECT_EQ(conversion.report.lines_in, 100u);
  EXPECT_EQ(conversion.report.lines_out, warped.indices.size() / 2);
  EXPECT_GT(conversion.report.lines_out, 500u) << "seed 5";
  EXPECT_LE(conversion.report.error_px_max, 0.5);
  EXPECT_GT(conversion.report.error_px_mean, 0);
  EXPECT_LE(largest_error_px(warped, {1024, 1024}), 0.5) << "seed 5";
}

TEST(Lines, OnTheEdgesOfTrianglesGetTheSamePoints) {
  const std::vector<Vec3f> corners = {{-3, -1, -2}, {4, -2, -3}, {0.5f, 3, -1}};
  Scene scene = triangles_scene(corners);
  Primitive outline = scene.meshes[0].primitives[0];
  outline.topology = Topology::lines;
  outline.indices = {0, 1, 2, 1, 2, 0}; // one of them against the triangle's direction
  scene.meshes[0].primitives.push_back(outline);
  const Conversion conversion = convert_shape(scene, lens(Lens::equidistant, 180));
  const std::vector<Primitive>& warped = conversion.scene.meshes[0].primitives;
  ASSERT_EQ(warped.size(), 2u);
  const std::set<Position> faces = positions_of(warped[0]), lines = positions_of(warped[1]);
  EXPECT_GT(lines.size(), 20u);
  EXPECT_TRUE(std::includes(faces.begin(), faces.end(), lines.begin(), lines.end()));
}

TEST(Lines, AreClippedAtTheVisibleRegion) {
  // Through the plane of 90 degrees, and one wholly behind.
  const Conversion conversion = convert_shape(lines_scene({{1, 0, -1}, {1, 0, 1}, {1, 1, 1}, {2, 1, 1}}), lens(Lens::equidistant, 180));
  const Primitive& warped = only_primitive(conversion);
  double nearest = 1;
  for (std::uint32_t v = 0; v < warped.positions.size(); ++v) {
    EXPECT_LE(source_at(warped, v).z, 1e-9);
    nearest = std::min(nearest, std::abs(source_at(warped, v).z));
  }
  EXPECT_LT(nearest, 1e-9) << "the line must reach the rim";
}

TEST(Lines, ThatSurroundTheAxisOrPassTheEyeEnd) {
  const std::vector<Vec3f> ends = {{-1, 0, -1e-6f}, {1, 0, -1e-6f}, {0, 0, -5}, {0, 0, 5}, {1e-20f, 0, 0}, {-1e-20f, 0, 0}};
  const Conversion conversion = convert_shape(lines_scene(ends), lens(Lens::equidistant, 180));
  EXPECT_TRUE(conversion.report.limits_hit.empty());
  EXPECT_LE(conversion.report.error_px_max, 0.5);
  for (const Vec3f& p : only_primitive(conversion).positions) EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
}

TEST(Lines, OfNoLengthAreDropped) {
  const Conversion conversion = convert_shape(lines_scene({{1, 0, -1}, {1, 0, -1}}), lens(Lens::equidistant, 180));
  EXPECT_TRUE(conversion.scene.meshes[0].primitives.empty());
}

TEST(Lines, InterpolateAttributesInSourceSpace) {
  Scene scene = lines_scene({{-2, 1, -3}, {3, 1, -1}});
  scene.meshes[0].primitives[0].attributes = {{"_T", 1, {0, 1}}};
  const Conversion conversion = convert_shape(scene, lens(Lens::equidistant, 180));
  const Primitive& warped = only_primitive(conversion);
  ASSERT_EQ(warped.attributes.size(), 2u);
  for (std::uint32_t v = 0; v < warped.positions.size(); ++v)
    EXPECT_NEAR(warped.attributes[0].values[v], (source_at(warped, v).x + 2) / 5, 1e-6);
}

TEST(Points, AreMappedAndClippedOneByOne) {
  Scene scene = lines_scene({{0, 1, -1}, {0, 0, -2}, {1, 0, 1}});
  Primitive& primitive = scene.meshes[0].primitives[0];
  primitive.topology = Topology::points;
  primitive.indices = {0, 1, 2};
  const Conversion conversion = convert_shape(scene, lens(Lens::equidistant, 180));
  const Primitive& warped = only_primitive(conversion);
  EXPECT_EQ(warped.topology, Topology::points);
  EXPECT_EQ(conversion.report.points_in, 3u);
  EXPECT_EQ(conversion.report.points_out, 2u);
  ASSERT_EQ(warped.positions.size(), 2u);
  // 45 degrees of 90 at distance sqrt(2): half the radius.
  EXPECT_NEAR(warped.positions[0].y / -warped.positions[0].z, 0.5, 1e-6);
  EXPECT_NEAR(warped.positions[1].y, 0, 1e-6);
}

} // namespace
} // namespace domewarp
