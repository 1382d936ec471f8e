// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/scene/view.h"
#include "gltf_file.h"

namespace domewarp::test {
namespace {

using Indices = std::vector<std::uint32_t>;

const Primitive& first(const Scene& scene) {
  return scene.meshes.at(0).primitives.at(0);
}

/// Six points on a zigzag, drawn in a mode.
Scene read_mode(int mode, int points = 6) {
  GltfFile file;
  std::vector<float> positions;
  for (int i = 0; i < points; ++i)
    positions.insert(positions.end(), {static_cast<float>(i), static_cast<float>(i % 2), 0});
  file.draw({{"attributes", {{"POSITION", file.add(positions, "VEC3")}}}, {"mode", mode}});
  return file.read();
}

/// Signed volume under the triangles in world space, seen from the origin.
double volume(const Scene& scene) {
  double sum = 0;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives)
      for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        const auto corner = [&](std::size_t k) {
          return to_world(instance.world, primitive.positions[primitive.indices[i + k]]);
        };
        sum += glm::dot(corner(0), glm::cross(corner(1), corner(2))) / 6;
      }
  return sum;
}

TEST(Read, GivesAnUnindexedTriangleItsIndices) {
  const Scene scene = triangle_file().read();
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(first(scene).indices, (Indices{0, 1, 2}));
  EXPECT_EQ(first(scene).positions[1], Vec3f(1, 0, 0));
  EXPECT_EQ(count_triangles(scene), 1u);
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
}

TEST(Read, TurnsEveryModeIntoLists) {
  EXPECT_EQ(first(read_mode(0, 3)).indices, (Indices{0, 1, 2}));
  EXPECT_EQ(first(read_mode(0, 3)).topology, Topology::points);
  EXPECT_EQ(first(read_mode(1, 4)).indices, (Indices{0, 1, 2, 3}));
  EXPECT_EQ(first(read_mode(2, 3)).indices, (Indices{0, 1, 1, 2, 2, 0}));
  EXPECT_EQ(first(read_mode(3, 3)).indices, (Indices{0, 1, 1, 2}));
  EXPECT_EQ(first(read_mode(3, 3)).topology, Topology::lines);
  EXPECT_EQ(first(read_mode(4)).indices, (Indices{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(first(read_mode(5, 5)).indices, (Indices{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  EXPECT_EQ(first(read_mode(6, 4)).indices, (Indices{1, 2, 0, 2, 3, 0}));
}

TEST(Read, DropsIndicesThatAreLeftOverWithAWarning) {
  const Scene scene = read_mode(4, 5);
  EXPECT_EQ(first(scene).indices, (Indices{0, 1, 2}));
  EXPECT_TRUE(warns(scene, "the last 2 of 5 indices are left over"));
}

TEST(Read, DropsAPrimitiveWithTooFewVerticesToDraw) {
  EXPECT_TRUE(read_mode(5, 2).instances.empty());
  EXPECT_TRUE(read_mode(2, 1).instances.empty());
}

TEST(Read, RefusesAnUnknownMode) {
  GltfFile file = triangle_file();
  file.root["meshes"][0]["primitives"][0]["mode"] = 7;
  EXPECT_NE(refusal(file).find("unknown mode 7"), std::string::npos);
}

TEST(Read, NormalisesIntegerComponents) {
  GltfFile file = triangle_file();
  json& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = file.add(std::vector<std::uint16_t>{0, 65535, 13107, 0, 0, 0}, "VEC2", true);
  attributes["COLOR_0"] = file.add_bytes({255, 0, 51, 255, 0, 0, 0, 255, 0, 0, 0, 0}, "VEC4", true);
  const Scene scene = file.read();
  const Attribute* texcoords = find_attribute(first(scene), "TEXCOORD_0");
  const Attribute* colors = find_attribute(first(scene), "COLOR_0");
  ASSERT_TRUE(texcoords && colors);
  EXPECT_EQ(texcoords->values, (std::vector<float>{0, 1, 0.2f, 0, 0, 0}));
  EXPECT_EQ(colors->components, 4);
  EXPECT_EQ(colors->values[2], 0.2f);
}

TEST(Read, ClampsTheMostNegativeNormalisedInteger) {
  GltfFile file = triangle_file();
  file.root["meshes"][0]["primitives"][0]["attributes"]["_X"] = file.add_bytes({128, 127, 129}, "SCALAR", true);
  file.root["accessors"].back()["componentType"] = 5120;
  EXPECT_EQ(find_attribute(first(file.read()), "_X")->values, (std::vector<float>{-1, 1, -1}));
}

TEST(Read, FollowsTheStrideOfAView) {
  GltfFile file;
  const std::vector<float> interleaved = {0, 0, 0, 0.25f, 0.5f, 1, 0, 0, 0.75f, 1, 0, 1, 0, 0, 0};
  const int view = file.add_view(interleaved.data(), interleaved.size() * sizeof(float));
  file.root["bufferViews"][0]["byteStride"] = 20;
  file.root["accessors"] = {
      {{"bufferView", view},
       {"componentType", 5126},
       {"count", 3},
       {"type", "VEC3"},
       {"min", {0, 0, 0}},
       {"max", {1, 1, 0}}},
      {{"bufferView", view}, {"byteOffset", 12}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}}};
  file.draw({{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}});
  const Scene scene = file.read();
  EXPECT_EQ(first(scene).positions[2], Vec3f(0, 1, 0));
  EXPECT_EQ(find_attribute(first(scene), "TEXCOORD_0")->values, (std::vector<float>{0.25f, 0.5f, 0.75f, 1, 0, 0}));
}

TEST(Read, PutsSparseValuesIntoZerosAndIntoData) {
  for (const bool on_data : {false, true}) {
    GltfFile file = triangle_file();
    const std::uint16_t index = 2;
    const float value[3] = {5, 6, 7};
    const int indices = file.add_view(&index, sizeof(index)), values = file.add_view(value, sizeof(value));
    json& accessor = file.root["accessors"][0];
    accessor["sparse"] = {{"count", 1},
                          {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                          {"values", {{"bufferView", values}}}};
    accessor["max"] = {5, 6, 7};
    if (on_data)
      accessor["min"] = {0, 0, 0};
    else
      accessor.erase("bufferView");
    const Scene scene = file.read();
    EXPECT_EQ(first(scene).positions[1], on_data ? Vec3f(1, 0, 0) : Vec3f(0));
    EXPECT_EQ(first(scene).positions[2], Vec3f(5, 6, 7));
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
  }
}

TEST(Read, KeepsCustomAttributesAndDropsJoints) {
  GltfFile file = triangle_file();
  json& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["_HEAT"] = file.add(std::vector<float>{1, 2, 3}, "SCALAR");
  attributes["JOINTS_0"] = file.add_bytes(std::vector<std::uint8_t>(12), "VEC4");
  attributes["WEIGHTS_0"] = file.add(std::vector<float>(12, 0.25f), "VEC4");
  const Scene scene = file.read();
  ASSERT_EQ(first(scene).attributes.size(), 1u);
  EXPECT_EQ(first(scene).attributes[0].name, "_HEAT");
}

TEST(Read, MultipliesMatricesDownTheTreeInDoublePrecision) {
  GltfFile file = triangle_file();
  file.root["nodes"] = {
      {{"name", "base"}, {"translation", {1e9, 0, 0}}, {"children", {1}}},
      {{"scale", {2, 3, 4}}, {"children", {2}}},
      {{"name", "leaf"}, {"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.125, 5, 6, 1}}}};
  file.root["scenes"][0]["nodes"] = {0};
  const Scene scene = file.read();
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].name, "leaf");
  EXPECT_EQ(scene.instances[0].world[3], Vec4(1e9 + 0.25, 15, 24, 1));
  EXPECT_EQ(scene.instances[0].world[1], Vec4(0, 3, 0, 0));
}

TEST(Read, TurnsByQuaternions) {
  GltfFile file = triangle_file();
  const double half = std::sqrt(0.5);
  file.root["nodes"][0]["rotation"] = {0, 0, half, half}; // 90 degrees about z: x becomes y
  const Scene scene = file.read();
  EXPECT_NEAR(scene.instances[0].world[0].y, 1, 1e-15);
  EXPECT_NEAR(scene.instances[0].world[1].x, -1, 1e-15);
}

TEST(Read, SwapsTheWindingWhereANodeMirrors) {
  GltfFile file = triangle_file();
  file.root["nodes"][0]["translation"] = {0, 0, 1};
  const double plain = volume(file.read());
  file.root["nodes"][0]["scale"] = {-1, 1, 1};
  const Scene mirrored = file.read();
  EXPECT_GT(plain, 0);
  EXPECT_NEAR(volume(mirrored), plain, 1e-12);
  // Negative control: without the swap the sign turns.
  Scene unswapped = mirrored;
  std::swap(unswapped.meshes[0].primitives[0].indices[1], unswapped.meshes[0].primitives[0].indices[2]);
  EXPECT_NEAR(volume(unswapped), -plain, 1e-12);
}

TEST(Read, SharesAMeshAmongInstancesThatDoNotMirrorDifferently) {
  GltfFile file = triangle_file();
  file.add_node({{"mesh", 0}, {"translation", {1, 0, 0}}});
  file.add_node({{"mesh", 0}, {"scale", {1, -1, 1}}});
  const Scene scene = file.read();
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh);
  EXPECT_NE(scene.instances[0].mesh, scene.instances[2].mesh);
}

TEST(Read, DrawsTheDefaultSceneOrTheOneAskedFor) {
  GltfFile file = triangle_file();
  file.root["nodes"] = {{{"mesh", 0}, {"name", "a"}}, {{"mesh", 0}, {"name", "b"}}};
  file.root["scenes"] = {{{"name", "day"}, {"nodes", {0}}}, {{"name", "night"}, {"nodes", {1}}}};
  file.root["scene"] = 1;
  EXPECT_EQ(file.read().instances[0].name, "b");
  EXPECT_EQ(file.read({.scene = "day"}).instances[0].name, "a");
  EXPECT_EQ(file.read({.scene = "0"}).name, "day");
  EXPECT_THROW(file.read({.scene = "dusk"}), Error);
  file.root.erase("scene");
  EXPECT_EQ(file.read().instances[0].name, "a");
  file.root.erase("scenes");
  EXPECT_EQ(file.read().instances.size(), 2u);
}

TEST(Read, PlacesCamerasAndLightsByTheirNodes) {
  GltfFile file = triangle_file();
  file.root["cameras"] = {
      {{"type", "perspective"}, {"name", "c"}, {"perspective", {{"yfov", 1.5}, {"znear", 0.1}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 1}, {"znear", 0}, {"zfar", 10}}}}};
  file.root["extensionsUsed"] = {"KHR_lights_punctual"};
  file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"color", {1, 0.5, 0}}, {"intensity", 3}, {"spot", {{"outerConeAngle", 0.6}}}}};
  file.add_node({{"camera", 0}, {"translation", {0, 0, 5}}});
  file.add_node({{"camera", 1}, {"name", "flat"}});
  file.add_node({{"translation", {0, 7, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const Scene scene = file.read();
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "c");
  EXPECT_EQ(scene.cameras[0].world[3].z, 5);
  EXPECT_EQ(scene.cameras[0].yfov, 1.5);
  EXPECT_EQ(scene.cameras[1].name, "flat");
  EXPECT_FALSE(scene.cameras[1].perspective);
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.lights[0].kind, LightKind::spot);
  EXPECT_EQ(scene.lights[0].outer_cone, 0.6);
  EXPECT_EQ(scene.lights[0].world[3].y, 7);
}

TEST(Read, HidesInvisibleNodesAndWhatHangsOnThem) {
  GltfFile file = triangle_file();
  file.root["extensionsUsed"] = {"KHR_node_visibility"};
  file.root["nodes"] = {{{"children", {1}}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}},
                        {{"mesh", 0}},
                        {{"mesh", 0}}};
  file.root["scenes"][0]["nodes"] = {0, 2};
  EXPECT_EQ(file.read().instances.size(), 1u);
}

TEST(Read, KeepsMaterialsAsTextAndAsNumbers) {
  GltfFile file = triangle_file();
  const json material = {{"name", "m"},
                         {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}, {"metallicFactor", 0.25}}},
                         {"emissiveFactor", {1, 0.5, 0}},
                         {"alphaMode", "MASK"},
                         {"extensions",
                          {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}},
                           {"KHR_materials_unlit", json::object()},
                           {"VENDOR_x", {{"y", {1, 2}}}}}}};
  file.root["materials"] = json::array({material}); // clang takes {material} for a copy
  file.root["extensionsUsed"] = {"KHR_materials_emissive_strength", "KHR_materials_unlit", "VENDOR_x"};
  const Scene scene = file.read();
  const Material& read = scene.materials.at(0);
  EXPECT_EQ(json::parse(read.json), material);
  EXPECT_EQ(read.base_color, Vec4(0.5, 0.25, 1, 1));
  EXPECT_EQ(read.emissive, Vec3(4, 2, 0));
  EXPECT_EQ(read.metallic, 0.25);
  EXPECT_EQ(read.alpha_mode, AlphaMode::mask);
  EXPECT_TRUE(read.unlit);
}

TEST(Read, ReadsTextureTransformsAndPrefersWebp) {
  GltfFile file = triangle_file();
  const std::vector<std::uint8_t> png = tiny_png();
  file.root["images"] = {{{"mimeType", "image/png"}, {"bufferView", file.add_view(png.data(), png.size())}},
                         {{"uri", "missing.webp"}}};
  file.root["samplers"] = {{{"wrapS", 33071}, {"minFilter", 9987}}};
  file.root["textures"] = {{{"source", 0}, {"sampler", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
  file.root["materials"] = {
      {{"emissiveTexture",
        {{"index", 0},
         {"texCoord", 1},
         {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}, {"rotation", 1}, {"texCoord", 0}}}}}}}}};
  file.root["extensionsUsed"] = {"EXT_texture_webp", "KHR_texture_transform"};
  const Scene scene = file.read();
  EXPECT_EQ(scene.textures.at(0).image, 1);
  EXPECT_EQ(scene.samplers.at(0).wrap_s, 33071);
  EXPECT_EQ(scene.samplers.at(0).wrap_t, 10497);
  EXPECT_EQ(scene.images.at(0).bytes, png);
  EXPECT_TRUE(scene.images.at(1).bytes.empty());
  EXPECT_TRUE(warns(scene, "missing.webp"));
  const TextureReference& reference = scene.materials.at(0).emissive_texture;
  EXPECT_EQ(reference.texcoord, 0);
  EXPECT_EQ(reference.offset, Vec2(0.5, 0));
  EXPECT_EQ(reference.rotation, 1);
}

TEST(Read, NormalisesNormalsAndInventsMissingDirections) {
  GltfFile file = triangle_file();
  file.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      file.add(std::vector<float>{0, 0, 3, 0, 0, 0, 1, 0, 0}, "VEC3");
  const Scene scene = file.read();
  EXPECT_EQ(find_attribute(first(scene), "NORMAL")->values, (std::vector<float>{0, 0, 1, 0, 0, 1, 1, 0, 0}));
  EXPECT_TRUE(warns(scene, "1 vectors are not unit"));
  EXPECT_TRUE(warns(scene, "1 vectors have no direction"));
}

TEST(Read, NamesTheExtensionsItDrops) {
  GltfFile file = triangle_file();
  file.root["extensionsUsed"] = {"OMI_physics_shape", "KHR_texture_transform"};
  EXPECT_EQ(file.read().dropped_extensions, (std::vector<std::string>{"OMI_physics_shape"}));
}

TEST(Read, WarnsOfWrongBoundsButNotOfRightOnes) {
  GltfFile file = triangle_file();
  EXPECT_TRUE(file.read().warnings.empty());
  file.root["accessors"][0]["max"] = {1, 2, 0};
  EXPECT_TRUE(warns(file.read(), "accessors[0].max"));
}

TEST(Read, ReadsBuffersFromFilesAndDataUris) {
  const TemporaryFolder folder;
  GltfFile file = triangle_file();
  write_bytes(folder / "my data.bin", file.binary);
  file.root["buffers"] = {{{"byteLength", 36}, {"uri", "my%20data.bin"}}};
  write_text(folder / "separate.gltf", file.root.dump());
  EXPECT_EQ(first(read_scene(folder / "separate.gltf")).positions[2], Vec3f(0, 1, 0));
  // 36 bytes: 0 0 0, 1 0 0, 0 1 0 as float32.
  file.root["buffers"][0]["uri"] =
      "data:application/gltf-buffer;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  write_text(folder / "embedded.gltf", file.root.dump());
  EXPECT_EQ(first(read_scene(folder / "embedded.gltf")).positions[2], Vec3f(0, 1, 0));
}

TEST(Read, AcceptsWholeNumbersSpelledAsFloats) {
  GltfFile file = triangle_file();
  file.root["accessors"][0]["count"] = 3.0;
  file.root["nodes"][0]["mesh"] = 0.0;
  EXPECT_EQ(count_triangles(file.read()), 1u);
}

TEST(Read, ReturnsTheExtrasOfAnEarlierRun) {
  GltfFile file = triangle_file();
  file.root["asset"]["copyright"] = "nobody";
  file.root["asset"]["extras"]["domewarp"] = {{"version", "1"}};
  const Scene scene = file.read();
  EXPECT_EQ(scene.copyright, "nobody");
  EXPECT_EQ(json::parse(scene.extras), json({{"version", "1"}}));
}

} // namespace
} // namespace domewarp::test
