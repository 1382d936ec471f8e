// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/vertex_order.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "domewarp/gltf/geometric_extensions.h"

namespace domewarp::test {
namespace {

/// A grid of n x n quads in shuffled order, each vertex with its number as an attribute; one vertex more that nothing uses.
Scene shuffled_grid(std::uint32_t n, AlphaMode mode) {
  Primitive primitive;
  primitive.material = 0;
  Attribute number{"_NUMBER", 1, {}};
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) primitive.positions.push_back(Vec3f(i, j, 0));
  primitive.positions.push_back(Vec3f(-1));
  for (std::size_t i = 0; i < primitive.positions.size(); ++i) number.values.push_back(static_cast<float>(i));
  primitive.attributes = {number};
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, c = a + n + 1;
      faces.push_back({a, a + 1, c});
      faces.push_back({a + 1, c + 1, c});
    }
  std::shuffle(faces.begin(), faces.end(), std::mt19937(3));
  for (const auto& face : faces) primitive.indices.insert(primitive.indices.end(), face.begin(), face.end());
  Scene scene;
  scene.meshes.push_back({"grid", {primitive}});
  scene.instances.push_back({"grid", 0, Mat4(1)});
  scene.materials.emplace_back().alpha_mode = mode;
  return scene;
}

/// The numbers of the vertices of each triangle, first the smallest, which keeps the winding.
std::vector<std::array<float, 3>> triangles(const Scene& scene) {
  const Primitive& primitive = scene.meshes[0].primitives[0];
  std::vector<std::array<float, 3>> result;
  for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
    auto& triangle = result.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = primitive.attributes[0].values[primitive.indices[i + k]];
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
  }
  return result;
}

/// Vertices that a first-in first-out cache of 16 misses, per triangle.
double cache_misses(const Primitive& primitive) {
  std::vector<std::uint32_t> cache;
  std::size_t misses = 0;
  for (const std::uint32_t index : primitive.indices) {
    if (std::find(cache.begin(), cache.end(), index) != cache.end()) continue;
    ++misses;
    cache.push_back(index);
    if (cache.size() > 16) cache.erase(cache.begin());
  }
  return 3.0 * static_cast<double>(misses) / static_cast<double>(primitive.indices.size());
}

TEST(VertexOrder, KeepsTheTrianglesAndSparesTheCache) {
  const Scene before = shuffled_grid(40, AlphaMode::opaque);
  Scene after = before;
  optimize_vertex_order(after);
  const Primitive& primitive = after.meshes[0].primitives[0];
  std::vector<std::array<float, 3>> a = triangles(before), b = triangles(after);
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  EXPECT_EQ(a, b);
  EXPECT_GT(cache_misses(before.meshes[0].primitives[0]), 2.5) << "the shuffle is no test";
  EXPECT_LT(cache_misses(primitive), 0.8);
  EXPECT_EQ(primitive.positions.size(), 41u * 41u) << "the vertex that nothing uses is dropped";
  for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
    const auto number = static_cast<std::uint32_t>(primitive.attributes[0].values[v]);
    EXPECT_EQ(primitive.positions[v], Vec3f(number / 41, number % 41, 0));
  }
}

TEST(VertexOrder, KeepsTheOrderOfBlendedTriangles) {
  const Scene before = shuffled_grid(10, AlphaMode::blend);
  Scene after = before;
  optimize_vertex_order(after);
  EXPECT_EQ(triangles(before), triangles(after));
}

TEST(VertexOrder, KeepsTheOrderWhereOneTriangleLiesOnAnother) {
  Scene before = shuffled_grid(10, AlphaMode::opaque);
  Primitive& primitive = before.meshes[0].primitives[0];
  const auto copy = static_cast<std::uint32_t>(primitive.positions.size());
  for (std::size_t k = 0; k < 3; ++k) { // the first triangle again, the other way round and with vertices of its own
    primitive.positions.push_back(primitive.positions[primitive.indices[2 - k]]);
    primitive.attributes[0].values.push_back(1000 + static_cast<float>(k));
  }
  primitive.indices.insert(primitive.indices.end(), {copy, copy + 1, copy + 2});
  Scene after = before;
  optimize_vertex_order(after);
  EXPECT_EQ(triangles(before), triangles(after));
}

TEST(GeometricExtensions, AreDroppedAndNamed) {
  Scene scene;
  scene.materials.emplace_back().json =
      R"({"extensions":{"KHR_materials_volume":{"thicknessFactor":1},"KHR_materials_ior":{"ior":1.3}},"name":"glass"})";
  scene.materials.emplace_back().json = R"({"extensions":{"KHR_materials_volume":{}}})";
  EXPECT_EQ(drop_geometric_extensions(scene), std::vector<std::string>{"KHR_materials_volume"});
  EXPECT_EQ(scene.materials[0].json, R"({"extensions":{"KHR_materials_ior":{"ior":1.3}},"name":"glass"})");
  EXPECT_EQ(scene.materials[1].json, "{}");
}

// Mesh_PrimitiveMode_01.gltf (lines, a number of indices that 3 does not divide) ended in an assertion of meshoptimizer.
TEST(VertexOrder, NumbersTheVerticesOfLinesAndPoints) {
  for (const Topology topology : {Topology::lines, Topology::points}) {
    Scene scene = shuffled_grid(1, AlphaMode::opaque);
    Primitive& primitive = scene.meshes[0].primitives[0];
    primitive.topology = topology;
    primitive.indices = {3, 1, 1, 0};
    optimize_vertex_order(scene);
    EXPECT_EQ(primitive.indices, (std::vector<std::uint32_t>{0, 1, 1, 2}));
    EXPECT_EQ(primitive.attributes[0].values, (std::vector<float>{3, 1, 0}));
    EXPECT_EQ(primitive.positions, (std::vector<Vec3f>{{1, 1, 0}, {0, 1, 0}, {0, 0, 0}}));
  }
}

} // namespace
} // namespace domewarp::test
