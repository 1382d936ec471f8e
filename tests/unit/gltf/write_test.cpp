// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/write.h"
#include "domewarp/scene/view.h"
#include "gltf_file.h"

namespace domewarp::test {
namespace {

Scene one_triangle() {
  return triangle_file().read();
}

json written(const Scene& scene, const WriteOptions& options = {}) {
  return document_of(encode_glb(scene, options));
}

Scene rewrite(const Scene& scene) {
  const TemporaryFolder folder;
  write_scene(scene, folder / "out.glb");
  return read_scene(folder / "out.glb");
}

/// Two images, textures and materials each, of which the triangle uses the second.
Scene textured() {
  GltfFile file = triangle_file();
  const std::vector<std::uint8_t> png = tiny_png();
  for (int i = 0; i < 2; ++i)
    file.root["images"].push_back({{"name", "i" + std::to_string(i)},
                                   {"mimeType", "image/png"},
                                   {"bufferView", file.add_view(png.data(), png.size())}});
  file.root["samplers"] = {{{"wrapS", 33071}}, {{"wrapS", 33648}, {"magFilter", 9728}}};
  file.root["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 1}, {"sampler", 1}, {"name", "t"}}};
  file.root["materials"] = {{{"name", "a"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
                            {{"name", "b"},
                             {"normalTexture", {{"index", 1}, {"scale", 0.5}}},
                             {"extras", {{"index", 77}}},
                             {"extensions",
                              {{"KHR_materials_clearcoat", {{"clearcoatTexture", {{"index", 1}}}}},
                               {"KHR_materials_variants", json::object()}}}}};
  file.root["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_materials_variants"};
  file.root["meshes"][0]["primitives"][0]["material"] = 1;
  file.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      file.add(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2");
  return file.read();
}

TEST(Write, WhatIsReadBackIsWhatWasWritten) {
  Scene scene = textured();
  scene.name = "scene";
  scene.copyright = "nobody";
  scene.extras = R"({"tolerance":0.5})";
  scene.instances[0].name = "object";
  scene.cameras.push_back({"camera", Mat4(1), true, 1.5707963267948966, 1.25, 0, 0, 0.1, 100});
  scene.lights.push_back({.name = "lamp",
                          .kind = LightKind::spot,
                          .color = Vec3(1, 0.5, 0.25),
                          .intensity = 7,
                          .range = 3,
                          .inner_cone = 0.1,
                          .outer_cone = 0.2});
  const Scene again = rewrite(scene);
  EXPECT_EQ(again.name, "scene");
  EXPECT_EQ(again.copyright, "nobody");
  EXPECT_EQ(json::parse(again.extras), json::parse(scene.extras));
  EXPECT_EQ(again.instances.at(0).name, "object");
  const Primitive &before = scene.meshes[0].primitives[0], &after = again.meshes.at(0).primitives.at(0);
  EXPECT_EQ(after.positions, before.positions);
  EXPECT_EQ(after.indices, before.indices);
  EXPECT_EQ(after.attributes.at(0).values, before.attributes.at(0).values);
  EXPECT_EQ(again.cameras.at(0).yfov, 1.5707963267948966);
  EXPECT_EQ(again.cameras.at(0).aspect, 1.25);
  EXPECT_EQ(again.lights.at(0).range, 3);
  EXPECT_EQ(again.lights.at(0).outer_cone, 0.2);
  EXPECT_TRUE(again.warnings.empty()) << again.warnings.front();
}

TEST(Write, GivesTheSameBytesForTheSameScene) {
  EXPECT_EQ(encode_glb(textured()), encode_glb(textured()));
  const std::vector<std::uint8_t> once = encode_glb(textured());
  EXPECT_EQ(encode_glb(rewrite(textured())), once);
}

TEST(Write, DropsWhatIsUnusedAndRenumbersTheRest) {
  const json root = written(textured());
  ASSERT_EQ(root["materials"].size(), 1u);
  EXPECT_EQ(root["textures"], json({{{"sampler", 0}, {"source", 0}, {"name", "t"}}}));
  EXPECT_EQ(root["images"][0]["name"], "i1");
  EXPECT_EQ(root["samplers"], json({{{"wrapS", 33648}, {"magFilter", 9728}}}));
  const json& material = root["materials"][0];
  EXPECT_EQ(material["name"], "b");
  EXPECT_EQ(material["normalTexture"], json({{"index", 0}, {"scale", 0.5}}));
  EXPECT_EQ(material["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"]["index"], 0);
  EXPECT_EQ(material["extras"]["index"], 77);
  EXPECT_FALSE(material["extensions"].contains("KHR_materials_variants"));
  EXPECT_EQ(root["extensionsUsed"], json({"KHR_materials_clearcoat"}));
  EXPECT_FALSE(root.contains("extensionsRequired"));
}

TEST(Write, RemovesReferencesToImagesWithoutBytes) {
  Scene scene = textured();
  scene.images[1].bytes.clear();
  const json root = written(scene);
  EXPECT_FALSE(root["materials"][0].contains("normalTexture"));
  EXPECT_FALSE(root.contains("textures"));
  EXPECT_FALSE(root.contains("images"));
}

TEST(Write, AddsUnlitOnlyWhereItIsMissing) {
  Scene scene = textured();
  EXPECT_FALSE(written(scene)["materials"][0]["extensions"].contains("KHR_materials_unlit"));
  scene.materials[1].unlit = true;
  const json root = written(scene);
  EXPECT_TRUE(root["materials"][0]["extensions"].contains("KHR_materials_unlit"));
  EXPECT_EQ(root["extensionsUsed"], json({"KHR_materials_clearcoat", "KHR_materials_unlit"}));
}

TEST(Write, DescribesMaterialsThatCameFromNoFile) {
  Scene scene = one_triangle();
  Material& made = scene.materials.emplace_back();
  made.base_color = Vec4(0.5, 1, 1, 1);
  made.emissive = Vec3(4, 2, 0);
  made.alpha_mode = AlphaMode::mask;
  scene.meshes[0].primitives[0].material = 0;
  const json material = written(scene)["materials"][0];
  EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorFactor"][0], 0.5);
  EXPECT_EQ(material["emissiveFactor"], json({1.0, 0.5, 0.0}));
  EXPECT_EQ(material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 4);
  EXPECT_EQ(rewrite(scene).materials[0].emissive, Vec3(4, 2, 0));
}

TEST(Write, RequiresWebpWhereNothingElseCanBeDrawn) {
  Scene scene = textured();
  scene.images[1].bytes = {'R', 'I', 'F', 'F', 8, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8', ' '};
  scene.images[1].mime = "image/webp";
  const json root = written(scene);
  EXPECT_EQ(root["textures"][0]["extensions"]["EXT_texture_webp"]["source"], 0);
  EXPECT_FALSE(root["textures"][0].contains("source"));
  EXPECT_EQ(root["extensionsRequired"], json({"EXT_texture_webp"}));
}

TEST(Write, ChoosesTheSmallestIndexTypeAndKeepsClearOfRestarts) {
  const auto type_for = [](std::uint32_t vertices) {
    Scene scene = one_triangle();
    Primitive& primitive = scene.meshes[0].primitives[0];
    primitive.positions.resize(vertices, Vec3f(1, 0, 0));
    primitive.indices = {0, 1, vertices - 1};
    const json root = written(scene);
    return root["accessors"][root["meshes"][0]["primitives"][0]["indices"].get<std::size_t>()]["componentType"]
        .get<int>();
  };
  EXPECT_EQ(type_for(255), 5121);
  EXPECT_EQ(type_for(256), 5123);
  EXPECT_EQ(type_for(65535), 5123);
  EXPECT_EQ(type_for(65536), 5125);
}

TEST(Write, PrintsBoundsThatReadBackExactly) {
  Scene scene = one_triangle();
  scene.meshes[0].primitives[0].positions = {{0.1f, -1e-38f, 3.4e38f}, {1.0f / 3, 0, 0}, {0, 0.7f, -0.3f}};
  const json accessor = written(scene)["accessors"][0];
  EXPECT_EQ(accessor["max"][0].get<double>(), static_cast<double>(1.0f / 3));
  EXPECT_EQ(accessor["min"][1].get<double>(), static_cast<double>(-1e-38f));
  EXPECT_EQ(accessor["max"][2].get<double>(), static_cast<double>(3.4e38f));
  EXPECT_TRUE(rewrite(scene).warnings.empty());
}

TEST(Write, SharesTheMeshOfInstances) {
  Scene scene = one_triangle();
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].world[3].x = 5;
  scene.instances.push_back(scene.instances[0]);
  scene.instances[2].world[0].x = -1;
  const json root = written(scene);
  EXPECT_FALSE(root["nodes"][0].contains("matrix"));
  EXPECT_EQ(root["nodes"][1]["mesh"], root["nodes"][0]["mesh"]);
  EXPECT_EQ(root["meshes"].size(), 2u) << "the mirrored instance has a mesh with the winding swapped";
}

TEST(Write, KeepsMirroredInstancesAsTheyAre) {
  GltfFile file = triangle_file();
  file.root["nodes"][0]["scale"] = {-2, 1, 1};
  const Scene scene = file.read(), again = rewrite(scene);
  EXPECT_EQ(again.instances[0].world, scene.instances[0].world);
  EXPECT_EQ(again.meshes[0].primitives[0].indices, scene.meshes[0].primitives[0].indices);
}

TEST(Write, SpellsLargeRotationsAsTranslationRotationAndScale) {
  GltfFile file = triangle_file();
  file.root["nodes"][0] = {{"mesh", 0},
                           {"translation", {1e6, 2, 3}},
                           {"rotation", {0.48, -0.36, 0.64, 0.48}},
                           {"scale", {1000, -2000, 1e-3}}};
  const Scene scene = file.read();
  const json node = written(scene)["nodes"][0];
  EXPECT_FALSE(node.contains("matrix"));
  EXPECT_EQ(node["translation"], json({1e6, 2.0, 3.0}));
  const Scene again = rewrite(scene);
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      EXPECT_NEAR(again.instances[0].world[c][r], scene.instances[0].world[c][r], 1e-12) << c << " " << r;
}

TEST(Write, KeepsLargeMatricesThatAreNearlyARotation) {
  Scene scene = one_triangle();
  for (const double skew : {0.0, 1e-13, 1e-9, 1e-5}) {
    scene.instances[0].world =
        100.0 * Mat4(Vec4(0.6, 0.8, 0, 0), Vec4(-0.8 + skew, 0.6, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, 0, 0, 0.01));
    const Scene again = rewrite(scene);
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r)
        EXPECT_NEAR(again.instances.at(0).world[c][r], scene.instances[0].world[c][r], 1e-12) << skew;
  }
}

TEST(Write, SplitsShearedNodesInTwo) {
  Scene scene = one_triangle();
  scene.instances[0].name = "sheared";
  scene.instances[0].world = Mat4(Vec4(1, 0, 0, 0), Vec4(0.5, 2, 0, 0), Vec4(0, 0, 0, 0), Vec4(1, 2, 3, 1));
  const json root = written(scene);
  ASSERT_EQ(root["nodes"].size(), 2u);
  EXPECT_FALSE(root["nodes"][0].contains("matrix"));
  const Scene again = rewrite(scene);
  ASSERT_EQ(again.instances.size(), 1u);
  EXPECT_EQ(again.instances[0].name, "sheared");
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) EXPECT_NEAR(again.instances[0].world[c][r], scene.instances[0].world[c][r], 1e-14);
}

TEST(Write, DropsTangentsWithoutNormalsAndFillsGapsInTexcoords) {
  Scene scene = one_triangle();
  scene.meshes[0].primitives[0].attributes = {{"TANGENT", 4, {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}},
                                              {"TEXCOORD_1", 2, {0, 0, 1, 0, 0, 1}},
                                              {"COLOR_1", 3, {0, 0, 1, 0, 0, 1, 1, 1, 1}}};
  const json root = written(scene);
  const json& attributes = root["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_FALSE(attributes.contains("TANGENT"));
  EXPECT_FALSE(attributes.contains("COLOR_1"));
  ASSERT_TRUE(attributes.contains("TEXCOORD_0"));
  EXPECT_FALSE(root["accessors"][attributes["TEXCOORD_0"].get<std::size_t>()].contains("bufferView"));
  EXPECT_EQ(find_attribute(rewrite(scene).meshes[0].primitives[0], "TEXCOORD_1")->values,
            (std::vector<float>{0, 0, 1, 0, 0, 1}));
}

TEST(Write, MakesNormalsUnitAndAttributesFinite) {
  Scene scene = one_triangle();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  scene.meshes[0].primitives[0].attributes = {{"NORMAL", 3, {0, 0, 2, 0, 0, 0, nan, 0, 0}}, {"_X", 1, {nan, 1, 2}}};
  const Scene again = rewrite(scene);
  EXPECT_EQ(again.meshes[0].primitives[0].attributes[0].values, (std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}));
  EXPECT_EQ(again.meshes[0].primitives[0].attributes[1].values, (std::vector<float>{0, 1, 2}));
}

TEST(Write, GivesAValidFileWhenNothingIsDrawn) {
  Scene scene = one_triangle();
  scene.meshes[0].primitives[0].indices.clear();
  for (const Scene& empty : {Scene{}, scene}) {
    const json root = written(empty);
    EXPECT_FALSE(root.contains("meshes"));
    EXPECT_FALSE(root.contains("buffers"));
    EXPECT_FALSE(root["scenes"][0].contains("nodes"));
    EXPECT_TRUE(rewrite(empty).instances.empty());
  }
}

TEST(Write, RefusesPositionsThatAreNotFinite) {
  Scene scene = one_triangle();
  scene.meshes[0].primitives[0].positions[1].y = std::numeric_limits<float>::infinity();
  for (const WriteOptions options : {WriteOptions{}, WriteOptions{.draco = true}, WriteOptions{.quantize = true}, WriteOptions{.meshopt = true}})
    EXPECT_THROW(encode_glb(scene, options), Error);
  EXPECT_THROW(encode_glb(one_triangle(), {.draco = true, .quantize = true}), Error);
  EXPECT_THROW(encode_glb(one_triangle(), {.draco = true, .meshopt = true}), Error);
}

TEST(Write, RefusesTextsThatAreNotJson) {
  Scene scene = one_triangle();
  scene.extras = "{";
  EXPECT_THROW(encode_glb(scene), Error);
  scene.extras.clear();
  scene.instances[0].name = "\xff";
  EXPECT_THROW(encode_glb(scene), Error);
}

TEST(Write, NamesTheFileItCannotWrite) {
  const TemporaryFolder folder;
  for (const std::string name : {"none/out.glb", "none/out.gltf"}) {
    try {
      write_scene(one_triangle(), folder / name);
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::output);
      EXPECT_NE(std::string(error.what()).find("none/out"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(write_scene(one_triangle(), folder / "out.obj"), Error);
}

TEST(Write, PutsBufferAndImagesBesideAGltf) {
  const TemporaryFolder folder;
  Scene scene = textured();
  scene.images[1].uri = "textures/wall%20paper.png";
  write_scene(scene, folder / "a b.gltf");
  EXPECT_EQ(read_file(folder / "textures/wall paper.png"), tiny_png());
  EXPECT_TRUE(std::filesystem::exists(folder / "a b.bin"));
  const json root = json::parse(std::ifstream(folder / "a b.gltf"));
  EXPECT_EQ(root["buffers"][0]["uri"], "a%20b.bin");
  EXPECT_EQ(root["images"][0], json({{"name", "i1"}, {"uri", "textures/wall%20paper.png"}}));
  const Scene again = read_scene(folder / "a b.gltf");
  EXPECT_TRUE(again.warnings.empty()) << again.warnings.front();
  EXPECT_EQ(again.images[0].bytes, tiny_png());
}

TEST(Write, RenamesImagesWhosePathIsNotSafe) {
  for (const std::string uri :
       {"../up.png", "/abs.png", ".hidden.png", "script.sh", "a/../../up.png", "http://x/y.png", ""}) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "in");
    Scene scene = textured();
    scene.images[1].uri = uri;
    write_scene(scene, folder / "in/out.gltf");
    EXPECT_EQ(json::parse(std::ifstream(folder / "in/out.gltf"))["images"][0]["uri"], "out.image1.png") << uri;
    EXPECT_EQ(read_file(folder / "in/out.image1.png"), tiny_png());
  }
}

TEST(Write, DoesNotOverwriteAnotherImage) {
  const TemporaryFolder folder;
  write_text(folder / "wall.png", "another picture");
  Scene scene = textured();
  scene.images[1].uri = "wall.png";
  write_scene(scene, folder / "out.gltf");
  EXPECT_EQ(read_file(folder / "wall.png").size(), 15u);
  EXPECT_EQ(read_scene(folder / "out.gltf").images[0].bytes, tiny_png());
}

TEST(Write, ExtrasAreCarriedOver) {
  GltfFile file = triangle_file();
  const std::vector<std::uint8_t> png = tiny_png();
  file.root["extras"] = {{"of", "root"}};
  file.root["asset"]["extras"] = {{"title", "a"}, {"domewarp", {{"tolerance", 1}}}};
  file.root["scenes"][0]["extras"] = {{"of", "scene"}};
  file.root["nodes"][0]["extras"] = {{"of", "node"}};
  file.root["meshes"][0]["extras"] = {{"of", "mesh"}, {"targetNames", {"smile"}}};
  file.root["meshes"][0]["primitives"][0]["extras"] = 7;
  file.root["images"] = {{{"mimeType", "image/png"}, {"bufferView", file.add_view(png.data(), png.size())}, {"extras", {{"of", "image"}}}}};
  file.root["samplers"] = {{{"extras", {{"of", "sampler"}}}}};
  file.root["textures"] = {{{"source", 0}, {"sampler", 0}, {"extras", {{"of", "texture"}}}}};
  file.root["materials"] = {{{"extras", {{"of", "material"}}}, {"emissiveTexture", {{"index", 0}}}}};
  file.root["meshes"][0]["primitives"][0]["material"] = 0;
  file.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}, {"extras", 1}}};
  file.add_node({{"camera", 0}, {"extras", {{"of", "a node without a mesh"}}}});
  const Scene scene = file.read();
  const json root = written(scene);
  EXPECT_EQ(root["extras"]["of"], "root");
  EXPECT_EQ(root["asset"]["extras"], (json{{"title", "a"}, {"domewarp", {{"tolerance", 1}}}}));
  EXPECT_EQ(root["scenes"][0]["extras"]["of"], "scene");
  EXPECT_EQ(root["nodes"][0]["extras"]["of"], "node");
  EXPECT_EQ(root["meshes"][0]["extras"], (json{{"of", "mesh"}})) << "targets are posed, their names mean nothing any more";
  EXPECT_EQ(root["meshes"][0]["primitives"][0]["extras"], 7);
  for (const char* list : {"image", "sampler", "texture", "material"}) EXPECT_EQ(root[std::string(list) + "s"][0]["extras"]["of"], list);
  EXPECT_EQ(scene.dropped_extras, (std::vector<std::string>{"cameras", "nodes"}));
}

} // namespace
} // namespace domewarp::test
