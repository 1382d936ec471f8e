// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "gltf_file.h"

namespace domewarp::test {
namespace {

const Primitive& first(const Scene& scene) {
  return scene.meshes.at(0).primitives.at(0);
}

/// The triangle, bound to two joints: the first corner to joint 0, the others to joint 1.
GltfFile skinned_file() {
  GltfFile file = triangle_file();
  json& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = file.add_bytes({0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  attributes["WEIGHTS_0"] = file.add(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  file.root["nodes"][0]["skin"] = 0;
  file.root["nodes"][0]["translation"] = {100, 100, 100}; // means nothing to a skinned mesh
  const int a = file.add_node({{"translation", {0, 0, 1}}}), b = file.add_node({{"translation", {0, 0, 2}}});
  file.root["skins"] = {{{"joints", {a, b}}}};
  return file;
}

TEST(Pose, FollowsTheJointsAndNotTheNode) {
  const Scene scene = skinned_file().read();
  EXPECT_EQ(scene.instances[0].world, Mat4(1));
  EXPECT_EQ(first(scene).positions[0], Vec3f(0, 0, 1));
  EXPECT_EQ(first(scene).positions[1], Vec3f(1, 0, 2));
}

TEST(Pose, UndoesTheBindPose) {
  GltfFile file = skinned_file();
  std::vector<float> matrices(32, 0);
  for (const std::size_t m : {0, 16})
    for (const std::size_t i : {0, 5, 10, 15}) matrices[m + i] = 1;
  matrices[16 + 12] = -1; // joint 1 was bound at x = 1
  file.root["skins"][0]["inverseBindMatrices"] = file.add(matrices, "MAT4");
  const Scene scene = file.read();
  EXPECT_EQ(first(scene).positions[1], Vec3f(0, 0, 2));
  EXPECT_EQ(first(scene).positions[0], Vec3f(0, 0, 1));
}

TEST(Pose, ScalesWeightsThatDoNotAddUp) {
  GltfFile file = skinned_file();
  const int weights = file.add(std::vector<float>{0.5f, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, "VEC4");
  file.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = weights;
  const Scene scene = file.read();
  EXPECT_EQ(first(scene).positions[0], Vec3f(0, 0, 1));
  EXPECT_EQ(first(scene).positions[2], Vec3f(0, 1, 2));
  EXPECT_TRUE(warns(scene, "the weights of 2 vertices do not add up to 1"));
}

TEST(Pose, TurnsNormalsWithTheJoints) {
  GltfFile file = skinned_file();
  file.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      file.add(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  file.root["nodes"][2]["rotation"] = {1, 0, 0, 0}; // half a turn about x
  const Scene scene = file.read();
  EXPECT_EQ(find_attribute(first(scene), "NORMAL")->values, (std::vector<float>{0, 0, 1, 0, 0, -1, 0, 0, -1}));
}

TEST(Pose, RefusesAJointThatDoesNotExist) {
  GltfFile file = skinned_file();
  file.root["skins"][0]["joints"] = {1};
  EXPECT_NE(refusal(file).find("refers to joint 1 of 1"), std::string::npos);
}

TEST(Pose, RefusesTooFewInverseBindMatrices) {
  GltfFile file = skinned_file();
  file.root["skins"][0]["inverseBindMatrices"] = file.add(std::vector<float>(16, 0), "MAT4");
  EXPECT_NE(refusal(file).find("has 1 for 2 joints"), std::string::npos);
}

/// The triangle with one morph target that lifts its corners by 1, 2 and 4.
GltfFile morphed_file() {
  GltfFile file = triangle_file();
  json& primitive = file.root["meshes"][0]["primitives"][0];
  primitive["targets"] = json::array({{{"POSITION", file.add(std::vector<float>{0, 0, 1, 0, 0, 2, 0, 0, 4}, "VEC3")}}});
  return file;
}

TEST(Pose, AddsMorphTargetsByTheWeightsOfMeshOrNode) {
  GltfFile file = morphed_file();
  EXPECT_EQ(first(file.read()).positions[2], Vec3f(0, 1, 0));
  file.root["meshes"][0]["weights"] = {0.5};
  EXPECT_EQ(first(file.read()).positions[2], Vec3f(0, 1, 2));
  file.root["nodes"][0]["weights"] = {-1.0};
  EXPECT_EQ(first(file.read()).positions[2], Vec3f(0, 1, -4));
}

TEST(Pose, MakesAMeshForEveryPoseOfIt) {
  GltfFile file = morphed_file();
  file.add_node({{"mesh", 0}, {"weights", {1}}});
  file.add_node({{"mesh", 0}, {"weights", {1}}});
  const Scene scene = file.read();
  EXPECT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.instances[1].mesh, scene.instances[2].mesh);
}

TEST(Pose, RefusesATargetOfAnotherLength) {
  GltfFile file = morphed_file();
  file.root["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = file.add(std::vector<float>{0, 0, 1}, "VEC3");
  EXPECT_NE(refusal(file).find("has 1 vertices, POSITION has 3"), std::string::npos);
}

TEST(Pose, MultipliesInstancesOut) {
  GltfFile file = triangle_file();
  const int translations = file.add(std::vector<float>{1, 0, 0, 2, 0, 0}, "VEC3"),
            scales = file.add(std::vector<float>{1, 1, 1, -1, 1, 1}, "VEC3");
  file.root["extensionsUsed"] = file.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  file.root["nodes"][0]["translation"] = {0, 0, 9};
  file.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", translations}, {"SCALE", scales}, {"_ID", scales}};
  const Scene scene = file.read();
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].world[3], Vec4(1, 0, 9, 1));
  EXPECT_EQ(scene.instances[1].world[0], Vec4(-1, 0, 0, 0));
  EXPECT_EQ(scene.meshes[static_cast<std::size_t>(scene.instances[1].mesh)].primitives[0].indices,
            (std::vector<std::uint32_t>{0, 2, 1}));
  file.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
      file.add(std::vector<float>{1, 1, 1}, "VEC3");
  EXPECT_NE(refusal(file).find("instances"), std::string::npos);
}

TEST(Pose, RefusesInstancesBeyondSinglePrecisionByName) {
  GltfFile file = triangle_file();
  file.root["extensionsUsed"] = file.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  file.root["nodes"][0]["scale"] = {1e30, 1e30, 1e30};
  file.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"SCALE", file.add(std::vector<float>{1, 1, 1, 1e20F, 1, 1}, "VEC3")}};
  EXPECT_NE(refusal(file).find("nodes[0].EXT_mesh_gpu_instancing: has a world matrix beyond what single precision holds at instance 1"), std::string::npos)
      << refusal(file);
  file.root["nodes"][0]["scale"] = {1, 1, 1};
  EXPECT_EQ(file.read().instances.size(), 2u);
}

} // namespace
} // namespace domewarp::test
