// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <meshoptimizer.h>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/write.h"
#include "domewarp/scene/view.h"
#include "gltf_file.h"

namespace domewarp::test {
namespace {

const Primitive& first(const Scene& scene) {
  return scene.meshes.at(0).primitives.at(0);
}

/// A bumpy sheet of n x n cells, as two primitives that share the line x = 0.
Scene sheet(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> height(-0.1f, 0.1f);
  std::vector<Vec3f> points;
  for (int y = 0; y <= n; ++y)
    for (int x = -n; x <= n; ++x)
      points.push_back({static_cast<float>(x) / 7, static_cast<float>(y) / 7, height(random)});
  Scene scene;
  scene.meshes.push_back({"sheet", {}});
  for (const int side : {-1, 0}) {
    Primitive& primitive = scene.meshes[0].primitives.emplace_back();
    Attribute texcoords{"TEXCOORD_0", 2, {}};
    for (int y = 0; y <= n; ++y)
      for (int x = 0; x <= n; ++x) {
        primitive.positions.push_back(points[static_cast<std::size_t>(y * (2 * n + 1) + x + (side + 1) * n)]);
        texcoords.values.insert(texcoords.values.end(), {static_cast<float>(x) / static_cast<float>(n),
                                                         static_cast<float>(y) / static_cast<float>(n)});
      }
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const auto corner = static_cast<std::uint32_t>(y * (n + 1) + x),
                   above = corner + static_cast<std::uint32_t>(n) + 1;
        primitive.indices.insert(primitive.indices.end(), {corner, corner + 1, above, corner + 1, above + 1, above});
      }
    primitive.attributes.push_back(texcoords);
  }
  scene.instances.push_back({"node", 0, Mat4(1)});
  return scene;
}

Scene rewrite(const Scene& scene, const WriteOptions& options) {
  const TemporaryFolder folder;
  write_scene(scene, folder / "out.glb", options);
  return read_scene(folder / "out.glb");
}

using World = std::array<double, 3>;

/// All world positions of one primitive, sorted.
std::vector<World> world_positions(const Scene& scene, std::size_t primitive) {
  std::vector<World> positions;
  for (const Instance& instance : scene.instances) {
    const Primitive& p = scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives.at(primitive);
    for (const std::uint32_t index : p.indices) {
      const Vec3 world = to_world(instance.world, p.positions[index]);
      positions.push_back({world.x, world.y, world.z});
    }
  }
  std::sort(positions.begin(), positions.end());
  return positions;
}

/// How many distinct positions two primitives have in common, to the bit.
std::size_t shared_positions(const Scene& scene) {
  std::vector<World> a = world_positions(scene, 0), b = world_positions(scene, 1), both;
  a.erase(std::unique(a.begin(), a.end()), a.end());
  b.erase(std::unique(b.begin(), b.end()), b.end());
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both.size();
}

/// The largest distance from a corner to the nearest corner of the other scene.
double distance(const Scene& a, const Scene& b) {
  double largest = 0;
  for (std::size_t primitive = 0; primitive < 2; ++primitive)
    for (const World& p : world_positions(a, primitive)) {
      double nearest = 1e300;
      for (const World& q : world_positions(b, primitive))
        nearest = std::min(nearest, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
      largest = std::max(largest, nearest);
    }
  return largest;
}

class Packed : public testing::TestWithParam<bool> {};

TEST_P(Packed, KeepsEqualPositionsEqualAcrossPrimitives) {
  const int n = 5;
  const Scene scene = sheet(n, 42);
  const WriteOptions options{.draco = GetParam(), .quantize = !GetParam()};
  const Scene packed = rewrite(scene, options);
  EXPECT_EQ(count_triangles(packed), count_triangles(scene));
  EXPECT_EQ(shared_positions(scene), static_cast<std::size_t>(n + 1));
  EXPECT_EQ(shared_positions(packed), static_cast<std::size_t>(n + 1)) << "seed 42";
  // Half a step of the grid in each direction, and the rounding of float32.
  const double step = 10.0 / 7 / (GetParam() ? 1048575 : 65535);
  EXPECT_LT(distance(packed, scene), std::sqrt(3.0) * 0.5 * step + 3e-7);
  EXPECT_TRUE(packed.warnings.empty()) << packed.warnings.front();
}

TEST_P(Packed, WritesLinesAndDegenerateTrianglesToo) {
  Scene scene = sheet(2, 1);
  scene.meshes[0].primitives[0].topology = Topology::lines;
  scene.meshes[0].primitives[1].indices = {0, 0, 0};
  const Scene packed = rewrite(scene, {.draco = GetParam(), .quantize = !GetParam()});
  EXPECT_EQ(packed.meshes[0].primitives.size(), 2u);
  EXPECT_EQ(packed.meshes[0].primitives[0].indices.size(), scene.meshes[0].primitives[0].indices.size());
}

TEST_P(Packed, KeepsEqualPositionsEqualAtEveryScale) {
  for (const float scale : {1e-5f, 1e-2f, 3e3f, 1e7f})
    for (const float offset : {0.0f, -12.3f, 1e3f}) {
      Scene scene = sheet(5, 11);
      for (Primitive& primitive : scene.meshes[0].primitives)
        for (Vec3f& p : primitive.positions) p = p * scale + Vec3f(offset * scale);
      const Scene packed = rewrite(scene, {.draco = GetParam(), .quantize = !GetParam()});
      EXPECT_EQ(shared_positions(packed), 6u) << "seed 11, scale " << scale << ", offset " << offset;
      EXPECT_LT(distance(packed, scene), (GetParam() ? 1e-5 : 1e-4) * scale * (1 + std::abs(offset) / 10))
          << scale << " " << offset;
    }
}

TEST_P(Packed, PutsLinesOnTheGridOfTheTriangles) {
  Scene scene = sheet(5, 9);
  Primitive& lines = scene.meshes[0].primitives[0];
  lines.topology = Topology::lines;
  lines.indices.clear();
  for (std::uint32_t i = 0; i + 1 < lines.positions.size(); ++i) lines.indices.insert(lines.indices.end(), {i, i + 1});
  EXPECT_EQ(shared_positions(rewrite(scene, {.draco = GetParam(), .quantize = !GetParam()})), 6u) << "seed 9";
}

TEST_P(Packed, KeepsAttributesOfOurOwnExactly) {
  Scene scene = sheet(3, 7);
  for (Primitive& primitive : scene.meshes[0].primitives) {
    Attribute source{"_SOURCE_POSITION", 3, {}};
    for (const Vec3f& p : primitive.positions) source.values.insert(source.values.end(), {p.x * 1.1f, p.y, p.z});
    primitive.attributes = {source};
  }
  const Scene packed = rewrite(scene, {.draco = GetParam(), .quantize = !GetParam()});
  auto expected = first(scene).attributes[0].values, found = first(packed).attributes.at(0).values;
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
}

INSTANTIATE_TEST_SUITE_P(Compression, Packed, testing::Bool(),
                         [](const auto& test) { return test.param ? "Draco" : "Quantized"; });

TEST(Compression, NoticesASeamThatOneGridPerPrimitiveWouldOpen) {
  // Negative control of the measure above: shifting one side by a billionth parts every pair.
  Scene scene = sheet(5, 42);
  for (Vec3f& p : scene.meshes[0].primitives[1].positions) p.z = std::nextafter(p.z, 1.0f);
  EXPECT_EQ(shared_positions(scene), 0u);
}

/// A file whose POSITION and indices are compressed by meshoptimizer, with a fallback buffer without data.
GltfFile meshopt_file() {
  GltfFile file;
  const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const std::vector<std::uint32_t> indices = {0, 1, 2, 2, 1, 3};
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(4, 12)),
      triangles(meshopt_encodeIndexBufferBound(6, 4));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), positions.data(), 4, 12));
  triangles.resize(meshopt_encodeIndexBuffer(triangles.data(), triangles.size(), indices.data(), 6));
  const auto add = [&](const std::vector<unsigned char>& stream, const char* mode, std::size_t count,
                       std::size_t stride) {
    file.binary.resize((file.binary.size() + 3) / 4 * 4);
    json view = {{"buffer", 1}, {"byteOffset", 0}, {"byteLength", count * stride}};
    view["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                     {"byteOffset", file.binary.size()},
                                                     {"byteLength", stream.size()},
                                                     {"byteStride", stride},
                                                     {"mode", mode},
                                                     {"count", count}};
    file.root["bufferViews"].push_back(view);
    file.binary.insert(file.binary.end(), stream.begin(), stream.end());
  };
  add(vertices, "ATTRIBUTES", 4, 12);
  add(triangles, "TRIANGLES", 6, 4);
  file.root["bufferViews"][0]["byteStride"] = 12;
  file.root["buffers"] = {
      {{"byteLength", file.binary.size()}},
      {{"byteLength", 1u << 30}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  file.root["accessors"] = {{{"bufferView", 0},
                             {"componentType", 5126},
                             {"count", 4},
                             {"type", "VEC3"},
                             {"min", {0, 0, 0}},
                             {"max", {1, 1, 0}}},
                            {{"bufferView", 1}, {"componentType", 5125}, {"count", 6}, {"type", "SCALAR"}}};
  file.root["extensionsUsed"] = file.root["extensionsRequired"] = {"EXT_meshopt_compression"};
  file.draw({{"attributes", {{"POSITION", 0}}}, {"indices", 1}});
  return file;
}

json& meshopt_of(GltfFile& file, std::size_t view) {
  return file.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
}

TEST(Compression, DecodesMeshoptStreams) {
  const Scene scene = meshopt_file().read();
  EXPECT_EQ(first(scene).positions[3], Vec3f(1, 1, 0));
  EXPECT_EQ(first(scene).indices.size(), 6u);
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
}

TEST(Compression, RefusesMeshoptClaimsThatTheBytesCannotHold) {
  GltfFile file = meshopt_file();
  meshopt_of(file, 0)["count"] = 1u << 30;
  EXPECT_NE(refusal(file).find("cannot hold 1073741824 elements"), std::string::npos);
}

TEST(Compression, RefusesBadMeshoptParameters) {
  const auto refused = [](std::size_t view, const char* key, const json& value) {
    GltfFile file = meshopt_file();
    meshopt_of(file, view)[key] = value;
    return refusal(file);
  };
  EXPECT_NE(refused(0, "byteStride", 6).find("byteStride 6"), std::string::npos);
  EXPECT_NE(refused(1, "count", 5).find("not whole triangles"), std::string::npos);
  EXPECT_NE(refused(0, "mode", "VERTICES").find("unknown mode"), std::string::npos);
  EXPECT_NE(refused(0, "filter", "QUATERNION").find("not supported"), std::string::npos);
  EXPECT_NE(refused(0, "byteLength", 1000).find("reaches"), std::string::npos);
  EXPECT_NE(refused(0, "byteLength", 5).find("not a valid meshopt stream"), std::string::npos);
  EXPECT_EQ(refused(0, "filter", "NONE"), "");
}

TEST(Compression, RefusesADracoStreamThatClaimsBillionsOfTriangles) {
  const std::vector<std::uint8_t> glb = encode_glb(sheet(2, 3), {.draco = true});
  const std::size_t head = std::search(glb.begin(), glb.end(), "DRACO", "DRACO" + 5) - glb.begin();
  ASSERT_LT(head, glb.size());
  const TemporaryFolder folder;
  std::vector<std::uint8_t> huge = glb;
  for (const std::size_t i : {12, 13, 14, 15}) huge[head + i] = 0xFF;
  write_bytes(folder / "huge.glb", huge);
  EXPECT_NE(refusal(folder / "huge.glb").find("claims"), std::string::npos);
}

// The next three came from fuzzing: Draco's encoder indexes a table by values that had overflowed.
TEST(Compression, RefusesPositionsThatSinglePrecisionCannotSubtract) {
  Scene scene = sheet(2, 3);
  scene.meshes[0].primitives[0].positions[0].x = -2.5e38f;
  scene.meshes[0].primitives[0].positions[1].x = 2.5e38f;
  EXPECT_THROW(encode_glb(scene, {.draco = true}), Error);
  EXPECT_NO_THROW(encode_glb(scene, {.quantize = true}));
}

TEST(Compression, CompressesTexcoordsOfAnyRange) {
  for (const float factor : {1e-44f, 1e-12f, 1e-3f, 31.0f, 1e4f, 3e38f}) {
    Scene scene = sheet(2, 3);
    for (Primitive& primitive : scene.meshes[0].primitives)
      for (float& value : primitive.attributes[0].values) value *= factor;
    const Attribute texcoords = rewrite(scene, {.draco = true}).meshes[0].primitives[0].attributes.at(0);
    const float largest = *std::max_element(texcoords.values.begin(), texcoords.values.end());
    EXPECT_NEAR(largest, factor, std::max(1.0 / 16384, 1e-6 * factor));
  }
}

TEST(Compression, CompressesColorsThatHardlyDiffer) {
  Scene scene = sheet(2, 3);
  for (Primitive& primitive : scene.meshes[0].primitives) {
    primitive.attributes[0] = {"COLOR_0", 3, std::vector<float>(3 * primitive.positions.size(), 0)};
    primitive.attributes[0].values[4] = 1e-42f;
  }
  EXPECT_EQ(rewrite(scene, {.draco = true}).meshes[0].primitives[0].attributes.at(0).values[4], 0);
}

TEST(Compression, SurvivesEveryFlippedByteOfADracoStream) {
  const std::vector<std::uint8_t> glb = encode_glb(sheet(3, 3), {.draco = true});
  const std::size_t head = std::search(glb.begin(), glb.end(), "DRACO", "DRACO" + 5) - glb.begin();
  const TemporaryFolder folder;
  std::size_t refused = 0, tried = 0;
  for (std::size_t i = head; i < glb.size(); i += 3, ++tried) {
    std::vector<std::uint8_t> bad = glb;
    bad[i] ^= 0x55;
    write_bytes(folder / "bad.glb", bad);
    refused += !refusal(folder / "bad.glb", {.max_bytes = std::size_t(1) << 28}).empty();
  }
  EXPECT_GT(refused, tried / 10);
}

} // namespace
} // namespace domewarp::test
