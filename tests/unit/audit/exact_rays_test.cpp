// SPDX-License-Identifier: Apache-2.0
#include "domewarp/audit/exact_rays.h"

#include <cmath>

#include <gtest/gtest.h>

namespace domewarp {
namespace {

Scene make_scene(std::vector<Vec3f> positions, std::vector<std::uint32_t> indices) {
  Scene scene;
  Primitive primitive;
  primitive.positions = std::move(positions);
  primitive.indices = std::move(indices);
  scene.meshes.push_back({"", {primitive}});
  scene.instances.push_back({"", 0, Mat4(1)});
  return scene;
}

TEST(ExactRays, ARayThroughACommonEdgeMeetsBothTriangles) {
  const ExactRays rays(make_scene({{-1, -1, -2}, {1, -1, -2}, {1, 1, -2}, {-1, 1, -2}}, {0, 1, 2, 0, 2, 3}), View{});
  const auto through = rays.crossings({0, 0, -1});
  ASSERT_EQ(through.size(), 2u);
  EXPECT_EQ(through[0].distance, 2);
  EXPECT_EQ(through[0].triangle, 0u);
  EXPECT_EQ(through[1].triangle, 1u);
  EXPECT_TRUE(through[0].front);
  EXPECT_EQ(through[0].normal, Vec3(0, 0, 1));
  EXPECT_EQ(rays.crossings(Vec3(0.1, -0.1, -1)).size(), 1u);
  EXPECT_TRUE(rays.crossings({0, 0, 1}).empty()) << "behind the eye";
}

TEST(ExactRays, ATriangleOneBitNearerComesFirst) {
  const float far = -1.0f, near = std::nextafter(-1.0f, 0.0f);
  std::vector<Vec3f> positions;
  for (const float z : {far, near, far})
    for (const Vec2f corner : {Vec2f(-1, -1), Vec2f(2, -1), Vec2f(-1, 2)}) positions.emplace_back(corner, z);
  const ExactRays rays(make_scene(positions, {0, 1, 2, 3, 4, 5, 6, 7, 8}), View{});
  const double third = 1.0 / 3;
  for (const Vec3 direction : {Vec3(0, 0, -1), Vec3(0.1, third, -1), Vec3(-0.7, 0.3, -1)}) {
    const auto crossings = rays.crossings(direction);
    ASSERT_EQ(crossings.size(), 3u);
    EXPECT_EQ(crossings[0].triangle, 1u);
    EXPECT_EQ(crossings[1].triangle, 0u) << "equal distances go by number";
    EXPECT_EQ(crossings[2].triangle, 2u);
  }
}

TEST(ExactRays, NothingSlipsBetweenNeighbours) {
  // A fan around a centre no ray coordinate of which is exact; rays aimed at points of its spokes.
  std::vector<Vec3f> positions = {{0.1f, 0.2f, -1.3f}};
  std::vector<std::uint32_t> indices;
  constexpr std::uint32_t spokes = 40;
  for (std::uint32_t i = 0; i < spokes; ++i) {
    const double angle = 2 * M_PI * i / spokes;
    positions.emplace_back(std::cos(angle), std::sin(angle), -1.3 + 0.2 * std::sin(3 * angle));
    indices.insert(indices.end(), {0, 1 + i, 1 + (i + 1) % spokes});
  }
  const ExactRays rays(make_scene(positions, indices), View{});
  for (std::uint32_t i = 1; i <= spokes; ++i)
    for (int k = 0; k < 50; ++k) {
      const Vec3 direction = glm::mix(Vec3(positions[0]), Vec3(positions[i]), k / 51.0);
      EXPECT_GE(rays.crossings(direction).size(), 1u) << i << " " << k;
    }
}

TEST(ExactRays, FlatAndEmptyScenesAreNoTrouble) {
  EXPECT_TRUE(ExactRays(Scene{}, View{}).crossings({0, 0, -1}).empty());
  const ExactRays flat(make_scene({{0, 0, -1}, {0, 0, -2}, {0, 0, -3}, {0, 1, -1}, {NAN, 0, 0}}, {0, 1, 2, 0, 1, 3, 0, 1, 4}), View{});
  EXPECT_TRUE(flat.crossings({0, 0, -1}).empty()) << "a ray in the plane of a triangle does not meet it";
}

} // namespace
} // namespace domewarp
