// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/scene/test_scenes/outline.h"
#include "domewarp/scene/test_scenes/solids.h"

namespace domewarp::test_scenes {
namespace {

double area(const std::vector<std::array<Vec2, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    EXPECT_GT(twice, 0);
    sum += 0.5 * twice;
  }
  return sum;
}

double volume(const Shape& shape) {
  double sum = 0;
  for (const Face& face : shape) sum += glm::dot(face.points[0], glm::cross(face.points[1], face.points[2])) / 6;
  return sum;
}

TEST(Circle, AgreesWithTheMathematicsLibrary) {
  const unsigned seed = 11;
  std::mt19937 random(seed);
  for (int i = 0; i < 10000; ++i) {
    const double turns = static_cast<double>(random()) / 4294967296.0 * 8 - 4;
    const Vec2 c = circle(turns);
    EXPECT_NEAR(c.x, std::cos(2 * pi * turns), 1e-14) << turns << " seed " << seed;
    EXPECT_NEAR(c.y, std::sin(2 * pi * turns), 1e-14) << turns << " seed " << seed;
  }
  EXPECT_EQ(circle(0.25), Vec2(0, 1));
  EXPECT_EQ(circle(-0.5), Vec2(-1, 0));
}

TEST(Triangulate, KeepsTheAreaAndTheCountWithHoles) {
  const Outline outer = rectangle(8, 6), first = shifted(rectangle(1, 1), {-2, 0}),
                second = shifted(rectangle(2, 1), {2, 1});
  const auto triangles = triangulate(outer, {first, second});
  EXPECT_EQ(triangles.size(), 12u + 2 * 2 - 2);
  EXPECT_EQ(area(triangles), 48 - 1 - 2);
}

TEST(Triangulate, RefusesAnOutlineThatCrossesItself) {
  EXPECT_THROW(triangulate({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, {}), Error);
}

TEST(Extrude, EnclosesAreaTimesDepth) {
  const Shape ring = extrude(rectangle(4, 4), {rectangle(2, 2)}, 0.5);
  EXPECT_EQ(ring.size(), 4u * 8 + 4 - 4);
  EXPECT_NEAR(volume(ring), 12 * 0.5, 1e-12);
}

TEST(Solids, HaveTheTrianglesTheyPromise) {
  EXPECT_EQ(box(Vec3(1)).size(), 12u);
  EXPECT_EQ(bevelled_box(Vec3(1), 0.1).size(), 44u);
  EXPECT_EQ(sphere(1, 12, 6).size(), 2u * 12 * 5);
  EXPECT_EQ(torus(1, 0.3, 10, 8).size(), 160u);
  EXPECT_EQ(icosphere(1, 3).size(), 180u);
  EXPECT_EQ(tube({{0, 0, 0}, {0, 1, 0}, {0, 2, 1}}, {0.1, 0.2, 0.1}, 5).size(), 2u * 5 * 3);
  EXPECT_EQ(screw_thread(0.8, 1, 0.4, 5, 12).size(), 4u * 12 * 5 + 6 * 12 + 4);
}

TEST(Solids, EncloseTheVolumeTheyShould) {
  EXPECT_EQ(volume(box({2, 3, 4})), 24);
  EXPECT_NEAR(volume(sphere(1, 64, 32)), 4 * pi / 3, 0.02);
  EXPECT_NEAR(volume(icosphere(1, 16)), 4 * pi / 3, 0.02);
  EXPECT_NEAR(volume(torus(2, 0.5, 64, 32)), 2 * pi * pi * 2 * 0.25, 0.1);
  EXPECT_NEAR(volume(cylinder(1, 2, 64)), 2 * pi, 0.02);
  EXPECT_NEAR(volume(tube({{0, 0, 0}, {3, 0, 0}}, {1, 1}, 64)), 3 * pi, 0.03);
}

TEST(Room, FacesInwards) {
  EXPECT_EQ(volume(room(rectangle(4, 5), 3, 0, 1, 2)), -60);
}

TEST(Pointing, TurnsTheYAxisWithoutBending) {
  for (const Vec3& tip : {Vec3(2, 0, 0), Vec3(0, 3, 0), Vec3(0, -1, 0), Vec3(1, 2, -3), Vec3(-5, 0.1, 0)}) {
    const Mat4 m = pointing(Vec3(0), tip);
    EXPECT_NEAR(glm::length(Vec3(m[1]) - glm::normalize(tip)), 0, 1e-14);
    EXPECT_NEAR(glm::dot(glm::cross(Vec3(m[0]), Vec3(m[1])), Vec3(m[2])), 1, 1e-14);
  }
}

TEST(MakeMesh, SharesSmoothVerticesAndSplitsCreases) {
  EXPECT_EQ(make_mesh("box", box(Vec3(1))).primitives.at(0).positions.size(), 24u);
  const Primitive round = make_mesh("sphere", remapped(sphere(1, 16, 8), Vec2(0), Vec2(0))).primitives.at(0);
  EXPECT_EQ(round.positions.size(), 16u * 7 + 2);
}

} // namespace
} // namespace domewarp::test_scenes
