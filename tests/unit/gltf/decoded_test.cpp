// SPDX-License-Identifier: Apache-2.0
// What compressed files say of themselves against what their streams hold: no validator looks inside them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <set>
#include <span>

#include <gtest/gtest.h>

#include "domewarp/gltf/draco.h"
#include "domewarp/gltf/write.h"
#include "gltf_file.h"

namespace domewarp::test {
namespace {

/// A bumpy sheet of n x n cells with everything that a vertex can carry, some lines along it, and points.
Scene rich_scene(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> number(0, 1);
  Primitive sheet;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) sheet.positions.push_back({static_cast<float>(x) / 3, static_cast<float>(y) / 3, number(random) - 5});
  for (std::uint32_t y = 0, row = static_cast<std::uint32_t>(n) + 1; y + 1 < row; ++y)
    for (std::uint32_t x = 0; x + 1 < row; ++x) {
      const std::uint32_t corner = y * row + x;
      sheet.indices.insert(sheet.indices.end(), {corner, corner + 1, corner + row, corner + 1, corner + row + 1, corner + row});
    }
  sheet.attributes = {{"NORMAL", 3, {}}, {"TEXCOORD_0", 2, {}}, {"COLOR_0", 4, {}}, {"_SOURCE_POSITION", 3, {}}, {"_ID", 1, {}}};
  for (Attribute& attribute : sheet.attributes)
    for (std::size_t i = 0; i < sheet.positions.size() * static_cast<std::size_t>(attribute.components); ++i)
      attribute.values.push_back(attribute.name == "NORMAL" ? static_cast<float>(i % 3 == 2) : number(random));
  Primitive lines = sheet, points = sheet;
  lines.topology = Topology::lines;
  lines.indices.clear();
  for (std::uint32_t i = 0; i + 1 < sheet.positions.size(); ++i) lines.indices.insert(lines.indices.end(), {i, i + 1});
  points.topology = Topology::points;
  points.indices = {3, 2, 0};
  Scene scene;
  scene.meshes.push_back({"rich", {sheet, lines, points}});
  scene.instances.push_back({"node", 0, Mat4(1)});
  return scene;
}

Scene reread(const std::vector<std::uint8_t>& glb) {
  const TemporaryFolder folder;
  write_bytes(folder / "out.glb", glb);
  Scene scene = read_scene(folder / "out.glb");
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
  return scene;
}

/// Each triangle from its smallest corner on: the codec may start it at another.
std::vector<std::array<std::uint32_t, 3>> triangles_of(const Primitive& primitive) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
    std::array<std::uint32_t, 3> corners = {primitive.indices[i], primitive.indices[i + 1], primitive.indices[i + 2]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    triangles.push_back(corners);
  }
  return triangles;
}

bool same_bits(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3f)) == 0;
}

TEST(Meshopt, GivesBackEveryBit) {
  for (const int n : {1, 3, 40, 300}) { // 300: indices of 32 bits
    const Scene scene = rich_scene(n, 5);
    const Scene plain = reread(encode_glb(scene)), packed = reread(encode_glb(scene, {.meshopt = true}));
    ASSERT_EQ(packed.meshes[0].primitives.size(), 3u);
    for (std::size_t p = 0; p < 3; ++p) {
      const Primitive &expected = plain.meshes[0].primitives[p], &found = packed.meshes[0].primitives[p];
      EXPECT_EQ(found.topology, expected.topology);
      EXPECT_TRUE(same_bits(found.positions, expected.positions)) << n << " " << p;
      ASSERT_EQ(found.attributes.size(), expected.attributes.size());
      for (std::size_t a = 0; a < found.attributes.size(); ++a) {
        EXPECT_EQ(found.attributes[a].name, expected.attributes[a].name);
        EXPECT_EQ(found.attributes[a].values, expected.attributes[a].values) << n << " " << found.attributes[a].name;
      }
      if (p == 0)
        EXPECT_EQ(triangles_of(found), triangles_of(expected)) << n;
      else
        EXPECT_EQ(found.indices, expected.indices) << n << " " << p;
    }
  }
}

TEST(Meshopt, GivesBackTheIntegersOfQuantize) {
  const Scene scene = rich_scene(12, 6);
  const Scene plain = reread(encode_glb(scene, {.quantize = true}));
  const Scene packed = reread(encode_glb(scene, {.quantize = true, .meshopt = true}));
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_TRUE(same_bits(packed.meshes[0].primitives[p].positions, plain.meshes[0].primitives[p].positions));
    for (std::size_t a = 0; a < plain.meshes[0].primitives[p].attributes.size(); ++a)
      EXPECT_EQ(packed.meshes[0].primitives[p].attributes[a].values, plain.meshes[0].primitives[p].attributes[a].values);
  }
}

TEST(Meshopt, FollowsTheRulesOfTheFallbackBuffer) {
  const std::vector<std::uint8_t> glb = encode_glb(rich_scene(40, 7), {.meshopt = true});
  const json root = document_of(glb);
  ASSERT_EQ(root["buffers"].size(), 2u);
  EXPECT_EQ(root["extensionsRequired"], json({"EXT_meshopt_compression"})); // a fallback without data
  EXPECT_TRUE(root["buffers"][1]["extensions"]["EXT_meshopt_compression"]["fallback"]);
  EXPECT_FALSE(root["buffers"][1].contains("uri"));
  std::size_t end = 0;
  std::set<std::string> modes;
  for (const json& view : root["bufferViews"]) {
    if (!view.contains("extensions")) { // it does not pay for three points
      EXPECT_EQ(view["buffer"], 0);
      continue;
    }
    const json& packed = view["extensions"]["EXT_meshopt_compression"];
    EXPECT_EQ(view["buffer"], 1);
    EXPECT_EQ(packed["buffer"], 0);
    EXPECT_EQ(view["byteLength"], packed["count"].get<std::size_t>() * packed["byteStride"].get<std::size_t>());
    EXPECT_GE(view["byteOffset"], end) << "views overlap";
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
    end = view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>();
    EXPECT_LE(end, root["buffers"][1]["byteLength"]);
    EXPECT_LE(packed["byteOffset"].get<std::size_t>() + packed["byteLength"].get<std::size_t>(), root["buffers"][0]["byteLength"]);
    // The versions that the extension prescribes: vertices 0, triangles and sequences 1.
    const std::size_t binary = 20 + (glb[12] | glb[13] << 8 | glb[14] << 16) + 8;
    const int head = glb[binary + packed["byteOffset"].get<std::size_t>()];
    EXPECT_EQ(head, packed["mode"] == "ATTRIBUTES" ? 0xA0 : packed["mode"] == "TRIANGLES" ? 0xE1 : 0xD1) << packed["mode"];
    modes.insert(packed["mode"]);
  }
  EXPECT_EQ(modes, (std::set<std::string>{"ATTRIBUTES", "INDICES", "TRIANGLES"}));
  EXPECT_FALSE(document_of(encode_glb(rich_scene(1, 7), {.meshopt = true})).contains("extensionsRequired")) << "nothing pays there";
}

std::span<const std::uint8_t> view_of(const std::vector<std::uint8_t>& glb, const json& view) {
  const std::size_t binary = 20 + (glb[12] | glb[13] << 8 | glb[14] << 16) + 8;
  return std::span(glb).subspan(binary + view["byteOffset"].get<std::size_t>(), view["byteLength"].get<std::size_t>());
}

/// What is wrong with one accessor over decoded values.
std::string accessor_defect(const json& accessor, const gltf::DracoAttribute& decoded, std::size_t vertices) {
  if (accessor["count"] != vertices) return decoded.name + ": count";
  if (accessor["type"] != (decoded.components == 1 ? "SCALAR" : "VEC" + std::to_string(decoded.components))) return decoded.name + ": type";
  const auto components = static_cast<std::size_t>(decoded.components);
  std::vector<double> low(components, 1e300), high(components, -1e300);
  for (std::size_t i = 0; i < decoded.values.size(); ++i) {
    if (!std::isfinite(decoded.values[i])) return decoded.name + ": not finite";
    low[i % components] = std::min(low[i % components], decoded.values[i]);
    high[i % components] = std::max(high[i % components], decoded.values[i]);
  }
  if (decoded.name == "POSITION" && !accessor.contains("min")) return "POSITION: no bounds";
  if (accessor.contains("min") && accessor["min"].get<std::vector<double>>() != low) return decoded.name + ": min";
  if (accessor.contains("max") && accessor["max"].get<std::vector<double>>() != high) return decoded.name + ": max";
  if (decoded.name != "NORMAL") return "";
  for (std::size_t i = 0; i + 2 < decoded.values.size(); i += 3)
    if (std::abs(std::hypot(decoded.values[i], decoded.values[i + 1], decoded.values[i + 2]) - 1) > 5e-4) return "NORMAL: not unit";
  return "";
}

/// The first thing that the document says of its Draco streams and that they do not hold; empty when there is none.
std::string draco_defect(const std::vector<std::uint8_t>& glb, const json& root, std::size_t& streams) {
  for (const json& mesh : root["meshes"])
    for (const json& primitive : mesh["primitives"]) {
      if (!primitive.contains("extensions")) continue;
      const json& draco = primitive["extensions"]["KHR_draco_mesh_compression"];
      gltf::AttributeMap ids;
      for (const auto& [name, id] : draco["attributes"].items()) ids.emplace_back(name, id.get<int>());
      gltf::Budget budget(std::size_t(1) << 30);
      const gltf::DracoMesh decoded =
          gltf::decode_draco(view_of(glb, root["bufferViews"][draco["bufferView"].get<std::size_t>()]), ids, "stream", budget);
      ++streams;
      if (decoded.attributes.size() != primitive["attributes"].size()) return "attributes";
      if (root["accessors"][primitive["indices"].get<std::size_t>()]["count"] != decoded.indices.size()) return "indices: count";
      for (const std::uint32_t index : decoded.indices)
        if (index >= decoded.vertices) return "indices: range";
      for (const gltf::DracoAttribute& attribute : decoded.attributes) {
        const json& accessor = root["accessors"][primitive["attributes"][attribute.name].get<std::size_t>()];
        if (const std::string defect = accessor_defect(accessor, attribute, decoded.vertices); !defect.empty()) return defect;
      }
    }
  return "";
}

TEST(Draco, HoldsWhatTheDocumentSays) {
  for (const int n : {1, 7, 60}) {
    Scene scene = rich_scene(n, 8);
    std::vector<Primitive>& primitives = scene.meshes[0].primitives;
    primitives.push_back(primitives[0]);
    primitives.back().indices.insert(primitives.back().indices.end(), {0, 0, 1, 2, 2, 2}); // dropped by Draco
    const std::vector<std::uint8_t> glb = encode_glb(scene, {.draco = true});
    std::size_t streams = 0;
    EXPECT_EQ(draco_defect(glb, document_of(glb), streams), "") << n;
    EXPECT_EQ(streams, 2u) << "the lines and points stay as they are";
  }
}

TEST(Draco, WouldBeCaughtLying) {
  // Negative control of the check above: each statement of the document changed by the least.
  const std::vector<std::uint8_t> glb = encode_glb(rich_scene(7, 8), {.draco = true});
  const json root = document_of(glb);
  const json& primitive = root["meshes"][0]["primitives"][0];
  const std::size_t position = primitive["attributes"]["POSITION"], indices = primitive["indices"];
  std::size_t streams = 0;
  const auto defect = [&](const std::function<void(json&)>& change) {
    json changed = root;
    change(changed);
    return draco_defect(glb, changed, streams);
  };
  EXPECT_EQ(defect([&](json& j) { j["accessors"][position]["count"] = 63; }), "POSITION: count");
  EXPECT_EQ(defect([&](json& j) { j["accessors"][indices]["count"] = 291; }), "indices: count");
  EXPECT_EQ(defect([&](json& j) { j["accessors"][position].erase("min"); }), "POSITION: no bounds");
  EXPECT_EQ(defect([&](json& j) {
              json& low = j["accessors"][position]["min"][2];
              low = std::nextafter(low.get<float>(), -100.0f);
            }),
            "POSITION: min");
  const std::size_t texcoords = primitive["attributes"]["TEXCOORD_0"];
  EXPECT_EQ(defect([&](json& j) { j["accessors"][texcoords]["type"] = "VEC3"; }), "TEXCOORD_0: type");
}

} // namespace
} // namespace domewarp::test
