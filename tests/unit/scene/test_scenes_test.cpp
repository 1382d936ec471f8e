// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/test_scenes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "domewarp/scene/image.h"
#include "domewarp/scene/view.h"
#include "mesh_checks.h"

namespace domewarp {
namespace {

using checks::Triangle;

const std::vector<TestScene>& scenes() {
  static const std::vector<TestScene> made = make_test_scenes();
  return made;
}

/// Calls visit(scene's name, primitive) for every primitive.
template <typename Visit>
void each_primitive(Visit&& visit) {
  for (const TestScene& test : scenes())
    for (const Mesh& mesh : test.scene.meshes)
      for (const Primitive& primitive : mesh.primitives) visit(test.name + ", " + mesh.name, primitive);
}

/// Corners of a tetrahedron that faces outwards.
std::vector<Triangle> tetrahedron() {
  const Vec3 o(0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  return {{o, y, x}, {o, x, z}, {o, z, y}, {x, y, z}};
}

TEST(TestScenes, HaveTheCountsOfTheThesis) {
  struct Row {
    std::string name;
    std::size_t objects, triangles;
  };
  const std::vector<Row> table1 = {
      {"cubes", 8, 336}, {"pool", 13, 2020}, {"hardware", 20, 4848}, {"toys", 86, 6934}, {"biology", 15, 17242}};
  ASSERT_EQ(scenes().size(), table1.size());
  for (std::size_t i = 0; i < table1.size(); ++i) {
    EXPECT_EQ(scenes()[i].name, table1[i].name);
    EXPECT_EQ(scenes()[i].scene.instances.size(), table1[i].objects) << table1[i].name;
    EXPECT_EQ(count_triangles(scenes()[i].scene), table1[i].triangles) << table1[i].name;
  }
}

TEST(TestScenes, AreTheSameEachTime) {
  const std::vector<TestScene> again = make_test_scenes();
  for (std::size_t s = 0; s < again.size(); ++s) {
    const Scene &a = scenes()[s].scene, &b = again[s].scene;
    ASSERT_EQ(a.meshes.size(), b.meshes.size());
    for (std::size_t m = 0; m < a.meshes.size(); ++m)
      for (std::size_t p = 0; p < a.meshes[m].primitives.size(); ++p) {
        const Primitive &one = a.meshes[m].primitives[p], &two = b.meshes[m].primitives[p];
        EXPECT_EQ(one.positions, two.positions);
        EXPECT_EQ(one.indices, two.indices);
        for (std::size_t k = 0; k < one.attributes.size(); ++k)
          EXPECT_EQ(one.attributes[k].values, two.attributes[k].values);
      }
    for (std::size_t i = 0; i < a.images.size(); ++i) EXPECT_EQ(a.images[i].bytes, b.images[i].bytes);
    for (std::size_t i = 0; i < a.materials.size(); ++i) EXPECT_EQ(a.materials[i].json, b.materials[i].json);
    for (std::size_t i = 0; i < a.instances.size(); ++i) EXPECT_EQ(a.instances[i].world, b.instances[i].world);
  }
}

/// A change detector, and the check that compilers, optimisation and processors agree: FNV-1a over all vertices.
TEST(TestScenes, HaveTheRecordedGeometry) {
  std::uint64_t hash = 14695981039346656037u;
  const auto mix = [&hash](double value) {
    for (std::uint64_t bits = std::bit_cast<std::uint64_t>(value + 0.0), i = 0; i < 8; ++i, bits >>= 8)
      hash = (hash ^ (bits & 255)) * 1099511628211u;
  };
  each_primitive([&](const std::string&, const Primitive& primitive) {
    for (const Vec3f& p : primitive.positions)
      for (int i = 0; i < 3; ++i) mix(p[i]);
    for (const Attribute& attribute : primitive.attributes)
      for (const float value : attribute.values) mix(value);
    for (const std::uint32_t index : primitive.indices) mix(index);
  });
  for (const TestScene& test : scenes())
    for (const Instance& instance : test.scene.instances)
      for (int i = 0; i < 16; ++i) mix(instance.world[i / 4][i % 4]);
  EXPECT_EQ(hash, 874403330957340550u);
}

TEST(TestScenes, HaveAttributesForEveryVertexAndIndicesInRange) {
  each_primitive([](const std::string& name, const Primitive& primitive) {
    EXPECT_EQ(primitive.topology, Topology::triangles);
    EXPECT_EQ(primitive.indices.size() % 3, 0u);
    for (const std::uint32_t index : primitive.indices) ASSERT_LT(index, primitive.positions.size()) << name;
    ASSERT_NE(find_attribute(primitive, "NORMAL"), nullptr) << name;
    for (const Attribute& attribute : primitive.attributes)
      EXPECT_EQ(attribute.values.size(), primitive.positions.size() * attribute.components)
          << name << " " << attribute.name;
  });
}

bool is_on_grid(double x, double grid) {
  return std::isfinite(x) && x * grid == std::floor(x * grid);
}

TEST(TestScenes, LieOnTheirGrids) {
  each_primitive([](const std::string& name, const Primitive& primitive) {
    for (const Vec3f& p : primitive.positions)
      for (int i = 0; i < 3; ++i) EXPECT_TRUE(is_on_grid(p[i], 16384)) << name;
    for (const Attribute& attribute : primitive.attributes)
      for (const float value : attribute.values) EXPECT_TRUE(is_on_grid(value, 4096)) << name << " " << attribute.name;
  });
  EXPECT_FALSE(is_on_grid(0.1, 16384));
}

TEST(TestScenes, HaveUnitNormalsOnTheSideTheTrianglesFace) {
  each_primitive([](const std::string& name, const Primitive& primitive) {
    const std::vector<float>& n = find_attribute(primitive, "NORMAL")->values;
    for (std::size_t i = 0; i + 2 < n.size(); i += 3)
      EXPECT_NEAR(glm::length(Vec3(n[i], n[i + 1], n[i + 2])), 1, 5e-4) << name;
    for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
      const auto corner = [&](std::size_t k) { return Vec3(primitive.positions[primitive.indices[i + k]]); };
      const Vec3 face = glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t v = 3 * primitive.indices[i + k];
        EXPECT_GT(glm::dot(face, Vec3(n[v], n[v + 1], n[v + 2])), 0.3) << name;
      }
    }
  });
}

TEST(TestScenes, HaveColorsBetweenZeroAndOne) {
  each_primitive([](const std::string& name, const Primitive& primitive) {
    const Attribute* color = find_attribute(primitive, "COLOR_0");
    if (!color) return;
    for (const float value : color->values) EXPECT_TRUE(value >= 0 && value <= 1) << name << " " << value;
  });
}

TEST(TestScenes, HaveNoDegenerateTriangles) {
  for (const TestScene& test : scenes())
    for (const Mesh& mesh : test.scene.meshes)
      for (const Triangle& t : checks::triangles_of(mesh))
        EXPECT_GT(checks::smallest_height(t), 5e-4) << test.name << ", " << mesh.name;
  EXPECT_EQ(checks::smallest_height({Vec3(0), Vec3(1), Vec3(2)}), 0);
}

/// Sides without a neighbour: four for each picture, pane, rug or fence, and the rims of lamp shades and the kite.
const std::map<std::string, int> open_sides = {
    {"pool room", 16},          {"pool lamp", 72},    {"hardware workshop", 12}, {"hardware pegboard", 4},
    {"hardware desk lamp", 24}, {"toys nursery", 12}, {"toys doll's house", 12}, {"toys kite", 4}};

TEST(TestScenes, AreWatertightButForPanelsAndShades) {
  std::set<std::string> seen;
  for (const TestScene& test : scenes())
    for (const Mesh& mesh : test.scene.meshes) {
      const std::string name = test.name + " " + mesh.name;
      const auto open = open_sides.find(name);
      const checks::EdgeUse use = checks::count_edge_uses(checks::triangles_of(mesh));
      EXPECT_EQ(use.open, open == open_sides.end() ? 0 : open->second) << name;
      EXPECT_EQ(use.crowded, 0) << name;
      if (open != open_sides.end()) seen.insert(name);
    }
  EXPECT_EQ(seen.size(), open_sides.size());
}

TEST(TestScenes, FaceOutwardsAndRoomsInwards) {
  for (const TestScene& test : scenes()) {
    EXPECT_LT(checks::signed_volume(checks::triangles_of(test.scene.meshes.front())), 0) << test.name;
    for (std::size_t i = 1; i < test.scene.meshes.size(); ++i) {
      const Mesh& mesh = test.scene.meshes[i];
      if (open_sides.contains(test.name + " " + mesh.name)) continue;
      EXPECT_GT(checks::signed_volume(checks::triangles_of(mesh)), 0) << test.name << ", " << mesh.name;
    }
  }
}

TEST(TestScenes, HaveNoTJunctionsInsideAnObject) {
  for (const TestScene& test : scenes())
    for (const Mesh& mesh : test.scene.meshes)
      EXPECT_EQ(checks::count_t_junctions(checks::triangles_of(mesh), 1e-7), 0) << test.name << ", " << mesh.name;
}

TEST(TestScenes, HaveNoTrianglesThatFightForAPlane) {
  for (const TestScene& test : scenes())
    EXPECT_EQ(checks::count_overlaps(checks::triangles_of(test.scene), 4e-4), 0) << test.name;
}

TEST(TestScenes, EncloseTheViewerOfEachCamera) {
  const unsigned seed = 7;
  std::mt19937 random(seed);
  for (const TestScene& test : scenes()) {
    const std::vector<Triangle> triangles = checks::triangles_of(test.scene);
    ASSERT_FALSE(test.scene.cameras.empty()) << test.name;
    for (const Camera& camera : test.scene.cameras) {
      ViewOptions options;
      options.camera = camera.name;
      const View view = resolve_view(test.scene, options);
      for (int i = 0; i < 300; ++i) {
        Vec3 direction;
        for (int k = 0; k < 3; ++k) direction[k] = static_cast<double>(random()) / 2147483648.0 - 1;
        const double distance = checks::cast(triangles, view.eye, glm::normalize(direction));
        EXPECT_TRUE(distance > 0.1 && distance < 60)
            << test.name << ", " << camera.name << ": " << distance << " m, seed " << seed;
      }
    }
  }
}

TEST(TestScenes, HaveMaterialsWhoseTextSaysTheSame) {
  for (const TestScene& test : scenes())
    for (const Material& material : test.scene.materials) {
      const auto json = nlohmann::json::parse(material.json);
      const auto& surface = json.at("pbrMetallicRoughness");
      EXPECT_EQ(json.at("name"), material.name);
      for (int i = 0; i < 4; ++i) EXPECT_EQ(surface.at("baseColorFactor").at(i).get<double>(), material.base_color[i]);
      EXPECT_EQ(surface.at("metallicFactor").get<double>(), material.metallic);
      EXPECT_EQ(surface.at("roughnessFactor").get<double>(), material.roughness);
      EXPECT_EQ(surface.contains("baseColorTexture") ? surface["baseColorTexture"].at("index").get<int>() : -1,
                material.base_texture.texture);
      for (int i = 0; i < 3; ++i)
        EXPECT_EQ(json.contains("emissiveFactor") ? json["emissiveFactor"].at(i).get<double>() : 0,
                  material.emissive[i]);
      EXPECT_EQ(json.value("alphaMode", "OPAQUE") == "MASK", material.alpha_mode == AlphaMode::mask);
      EXPECT_EQ(json.value("doubleSided", false), material.double_sided);
      EXPECT_EQ(json.contains("extensions") && json["extensions"].contains("KHR_materials_unlit"), material.unlit);
    }
}

TEST(TestScenes, HaveTextureCoordinatesWhereAMaterialReadsThem) {
  for (const TestScene& test : scenes())
    for (const Mesh& mesh : test.scene.meshes)
      for (const Primitive& primitive : mesh.primitives) {
        const bool is_textured = test.scene.materials.at(primitive.material).base_texture.texture >= 0;
        EXPECT_EQ(find_attribute(primitive, "TEXCOORD_0") != nullptr, is_textured) << test.name << ", " << mesh.name;
      }
}

TEST(TestScenes, HaveSmallPicturesThatAreAllUsed) {
  for (const TestScene& test : scenes()) {
    const Scene& scene = test.scene;
    std::set<int> used_materials, used_images;
    for (const Mesh& mesh : scene.meshes)
      for (const Primitive& primitive : mesh.primitives) used_materials.insert(primitive.material);
    EXPECT_EQ(used_materials.size(), scene.materials.size()) << test.name;
    EXPECT_TRUE(*used_materials.begin() == 0 &&
                *used_materials.rbegin() + 1 == static_cast<int>(scene.materials.size()))
        << test.name;
    for (const Material& material : scene.materials)
      if (material.base_texture.texture >= 0)
        used_images.insert(scene.textures.at(material.base_texture.texture).image);
    EXPECT_EQ(used_images.size(), scene.images.size()) << test.name;
    for (const Image& image : scene.images) {
      const Pixels pixels = decode_image(image.bytes, image.name);
      EXPECT_LE(std::max(pixels.width, pixels.height), 256) << image.name;
      EXPECT_EQ(image.mime, "image/png");
    }
  }
}

TEST(TestScenes, ShowEveryKindOfMaterialAndVertex) {
  bool color = false, seam = false, mask = false, unlit = false, double_sided = false, instancing = false;
  each_primitive([&](const std::string&, const Primitive& primitive) {
    color = color || find_attribute(primitive, "COLOR_0") != nullptr;
    std::set<std::array<float, 3>> places;
    for (const Vec3f& p : primitive.positions) seam = seam || !places.insert({p.x, p.y, p.z}).second;
  });
  for (const TestScene& test : scenes()) {
    instancing = instancing || test.scene.instances.size() > test.scene.meshes.size();
    EXPECT_FALSE(test.scene.lights.empty()) << test.name;
    for (const Material& material : test.scene.materials) {
      mask = mask || material.alpha_mode == AlphaMode::mask;
      unlit = unlit || material.unlit;
      double_sided = double_sided || material.double_sided;
    }
  }
  EXPECT_TRUE(color && seam && mask && unlit && double_sided && instancing);
}

TEST(MeshChecks, FindAnOpenSideAndACrowdedOne) {
  std::vector<Triangle> triangles = tetrahedron();
  EXPECT_EQ(checks::count_edge_uses(triangles).open, 0);
  EXPECT_EQ(checks::count_edge_uses(triangles).crowded, 0);
  EXPECT_GT(checks::signed_volume(triangles), 0);
  std::swap(triangles[0][1], triangles[0][2]);
  EXPECT_EQ(checks::count_edge_uses(triangles).crowded, 3);
  triangles.erase(triangles.begin());
  EXPECT_EQ(checks::count_edge_uses(triangles).open, 3);
}

TEST(MeshChecks, FindATJunction) {
  std::vector<Triangle> triangles = tetrahedron();
  EXPECT_EQ(checks::count_t_junctions(triangles, 1e-7), 0);
  triangles.push_back({Vec3(0, 0, 0.5), Vec3(-1, 0, 0), Vec3(-1, 0, 1)});
  EXPECT_EQ(checks::count_t_junctions(triangles, 1e-7), 1);
}

TEST(MeshChecks, FindAnOverlapInAPlane) {
  std::vector<Triangle> triangles = tetrahedron();
  EXPECT_EQ(checks::count_overlaps(triangles, 1e-4), 0);
  triangles.push_back({Vec3(0.1, 0.1, 0.00005), Vec3(2, 0.1, 0.00005), Vec3(2, 2, 0.00005)});
  EXPECT_EQ(checks::count_overlaps(triangles, 1e-4), 1);
  triangles.back() = {Vec3(0, -1, 0), Vec3(1, -1, 0), Vec3(0, 0, 0)};
  EXPECT_EQ(checks::count_overlaps(triangles, 1e-4), 0);
}

TEST(MeshChecks, SeeThroughBacksAndOutOfOpenRooms) {
  EXPECT_NEAR(checks::cast(tetrahedron(), Vec3(0.2, 0.2, -1), Vec3(0, 0, 1)), 1, 1e-12);
  EXPECT_TRUE(std::isinf(checks::cast(tetrahedron(), Vec3(0.1), Vec3(0, 0, 1))));
}

} // namespace
} // namespace domewarp
