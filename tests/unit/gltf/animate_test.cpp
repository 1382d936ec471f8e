// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "gltf_file.h"

namespace domewarp::test {
namespace {

struct Key {
  std::vector<float> times, values;
  const char* type = "VEC3";
  const char* interpolation = "LINEAR";
};

/// The triangle, whose node the animation "move" moves.
GltfFile animated_file(const char* path, const Key& key) {
  GltfFile file = triangle_file();
  const int input = file.add(key.times, "SCALAR"), output = file.add(key.values, key.type);
  file.root["accessors"][static_cast<std::size_t>(input)]["min"] = {key.times.front()};
  file.root["accessors"][static_cast<std::size_t>(input)]["max"] = {key.times.back()};
  file.root["animations"] = {{{"name", "move"},
                              {"samplers", {{{"input", input}, {"output", output}, {"interpolation", key.interpolation}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
  return file;
}

Vec3 place_at(const GltfFile& file, double time, const std::string& animation = "move") {
  return Vec3(file.read({.animation = animation, .time = time}).instances.at(0).world[3]);
}

TEST(Animation, MovesBetweenKeysAndHoldsBeyondThem) {
  const GltfFile file = animated_file("translation", {{1, 3}, {0, 0, 0, 4, 0, 0}});
  EXPECT_EQ(place_at(file, 2), Vec3(2, 0, 0));
  EXPECT_EQ(place_at(file, 2.5, "0"), Vec3(3, 0, 0));
  EXPECT_EQ(place_at(file, 0), Vec3(0, 0, 0));
  EXPECT_EQ(place_at(file, 99), Vec3(4, 0, 0));
}

TEST(Animation, IsNotAppliedUnasked) {
  const GltfFile file = animated_file("translation", {{0, 1}, {7, 0, 0, 8, 0, 0}});
  EXPECT_EQ(file.read().instances.at(0).world, Mat4(1));
}

TEST(Animation, StepsHoldTheLastKey) {
  const GltfFile file = animated_file("translation", {{0, 1}, {1, 0, 0, 2, 0, 0}, "VEC3", "STEP"});
  EXPECT_EQ(place_at(file, 0.999).x, 1);
  EXPECT_EQ(place_at(file, 1).x, 2);
}

TEST(Animation, FollowsCubicTangents) {
  // From 0 to 1 over 2 seconds, leaving with slope 1 and arriving at rest: p(1/2) = 1/2 + 2 * 1/8.
  const Key key{{0, 2}, {0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}, "VEC3", "CUBICSPLINE"};
  const GltfFile file = animated_file("translation", key);
  EXPECT_EQ(place_at(file, 0).x, 0);
  EXPECT_NEAR(place_at(file, 1).x, 0.75, 1e-12);
  EXPECT_EQ(place_at(file, 2).x, 1);
}

TEST(Animation, TurnsAtConstantSpeedTheShorterWay) {
  const float s = std::sqrt(0.5f); // from 0 to 90 degrees about z, the second key with its sign flipped
  const GltfFile file = animated_file("rotation", {{0, 1}, {0, 0, 0, 1, 0, 0, -s, -s}, "VEC4"});
  const Mat4 world = file.read({.animation = "move", .time = 1.0 / 3}).instances.at(0).world;
  EXPECT_NEAR(world[0][0], std::cos(M_PI / 6), 1e-7);
  EXPECT_NEAR(world[0][1], std::sin(M_PI / 6), 1e-7);
}

TEST(Animation, BlendsMorphTargets) {
  GltfFile file = triangle_file();
  const int target = file.add(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  json& accessor = file.root["accessors"][static_cast<std::size_t>(target)];
  accessor["min"] = {0, 0, 1}, accessor["max"] = {0, 0, 1};
  file.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", target}}};
  const int input = file.add(std::vector<float>{0, 1}, "SCALAR"), output = file.add(std::vector<float>{0, 1}, "SCALAR");
  file.root["animations"] = {{{"samplers", {{{"input", input}, {"output", output}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
  const Scene scene = file.read({.animation = "0", .time = 0.25});
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).positions[0], Vec3f(0, 0, 0.25f));
}

TEST(Animation, ThatDoesNotExistIsAUsageError) {
  const GltfFile file = animated_file("translation", {{0, 1}, {0, 0, 0, 1, 0, 0}});
  try {
    file.read({.animation = "jump"});
    FAIL() << "read";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_STREQ(error.what(), "--animation jump: the file has 1 animation(s) and none of that name or index");
  }
}

TEST(Animation, WithBrokenKeysIsRefused) {
  const ReadOptions asked{.animation = "move"};
  EXPECT_NE(refusal(animated_file("translation", {{1, 0}, {0, 0, 0, 1, 0, 0}}), asked).find("do not ascend at key 1"), std::string::npos);
  EXPECT_NE(refusal(animated_file("translation", {{0, 1}, {0, 0, 0}}), asked).find("has 3 numbers for 2 keys of 3"), std::string::npos);
  EXPECT_NE(refusal(animated_file("scale", {{0, 1}, {0, 0, 0, NAN, 0, 0}}), asked).find("not finite"), std::string::npos);
}

TEST(Animation, LeavesNodesWithAMatrixAlone) {
  GltfFile file = animated_file("translation", {{0, 1}, {5, 0, 0, 6, 0, 0}});
  file.root["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 9, 0, 0, 1};
  const Scene scene = file.read({.animation = "move"});
  EXPECT_EQ(scene.instances.at(0).world[3][0], 9);
  EXPECT_TRUE(warns(scene, "has a matrix"));
}

} // namespace
} // namespace domewarp::test
