// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/convert/convert.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"

namespace domewarp {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

const Vec3 lamp(0.5, 1.5, -3);
constexpr double candela = 8, floor_height = -1;

void add_quad(Scene& scene, const std::array<Vec3f, 4>& corners, int material) {
  Primitive primitive;
  primitive.material = material;
  primitive.positions.assign(corners.begin(), corners.end());
  primitive.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back({"quad", {primitive}});
  scene.instances.push_back({"quad", static_cast<int>(scene.meshes.size()) - 1, Mat4(1)});
}

/// A floor below the eye and a lamp above it.
Scene lit_floor() {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].double_sided = true;
  const float y = floor_height;
  add_quad(scene, {Vec3f(-4, y, 2), Vec3f(4, y, 2), Vec3f(4, y, -8), Vec3f(-4, y, -8)}, 0);
  Light light;
  light.world[3] = Vec4(lamp, 1);
  light.intensity = candela;
  scene.lights = {light};
  return scene;
}

ConvertOptions baking() {
  ConvertOptions options;
  options.surface.lens = Lens::equidistant;
  options.raster = {512, 512};
  options.view.eye = Vec3(0);
  options.view.forward = Vec3(0, 0, -1);
  options.shading = Shading::bake;
  options.refine.source_attributes = true;
  return options;
}

double light_on_floor(const Vec3& p) {
  const Vec3 path = lamp - p;
  const double distance = glm::length(path);
  return candela / std::numbers::pi * path.y / (distance * distance * distance);
}

double srgb_step(double linear) {
  const double y = std::min(linear, 1.0);
  return 255 * (y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055);
}

struct Sample {
  Vec3 eye;
  double red;
};

/// Points inside the triangles of the first mesh, with the colour that interpolation gives them.
std::vector<Sample> sample_floor(const Scene& warped) {
  std::vector<Sample> samples;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform;
  for (const Primitive& primitive : warped.meshes[0].primitives) {
    const Attribute &source = *find_attribute(primitive, "_SOURCE_POSITION"), &colour = *find_attribute(primitive, "COLOR_0");
    for (std::size_t f = 0; f + 2 < primitive.indices.size(); f += 3) {
      Vec3 weights(uniform(random), uniform(random), uniform(random));
      weights /= weights.x + weights.y + weights.z;
      Sample sample{Vec3(0), 0};
      for (int k = 0; k < 3; ++k) {
        const std::size_t v = primitive.indices[f + static_cast<std::size_t>(k)];
        for (int c = 0; c < 3; ++c) sample.eye[c] += weights[k] * double(source.values[3 * v + static_cast<std::size_t>(c)]);
        sample.red += weights[k] * double(colour.values[static_cast<std::size_t>(colour.components) * v]);
      }
      samples.push_back(sample);
    }
  }
  return samples;
}

double largest_error(const Scene& warped) {
  double largest = 0;
  for (const Sample& s : sample_floor(warped)) largest = std::max(largest, std::abs(srgb_step(s.red) - srgb_step(light_on_floor(s.eye))));
  return largest;
}

TEST(Bake, InterpolatesTheLightWithinTheTolerance) {
  for (const double tolerance : {8.0, 4.0, 2.0}) {
    ConvertOptions options = baking();
    options.bake.tolerance = tolerance;
    ConvertReport report;
    const Scene warped = convert(lit_floor(), options, report);
    EXPECT_LE(largest_error(warped), 1.5 * tolerance) << tolerance; // promised along edges; faces are a little worse
    EXPECT_EQ(report.refine.open_edges, 0u);
    EXPECT_TRUE(warped.materials[0].unlit);
    EXPECT_THAT(warped.lights, IsEmpty());
  }
}

TEST(Bake, WithoutVerticesForItTheErrorIsSeen) {
  ConvertOptions options = baking();
  options.refine.subdivision = Subdivision::isotropic;
  options.refine.isotropic.max_lod = 0;
  ConvertReport report;
  EXPECT_GT(largest_error(convert(lit_floor(), options, report)), 20);
}

/// Where the square plate of `with_plate` keeps the lamp's light from the floor; positive inside, a distance.
double depth_in_shadow(const Vec3& p) {
  const double t = (0.25 - floor_height) / (lamp.y - floor_height);
  const Vec3 crossing = p + t * (lamp - p);
  return std::min(0.5 - std::abs(crossing.x - 0.5), 0.5 - std::abs(crossing.z + 3));
}

Scene with_plate() {
  Scene scene = lit_floor();
  add_quad(scene, {Vec3f(0, 0.25f, -3.5f), Vec3f(1, 0.25f, -3.5f), Vec3f(1, 0.25f, -2.5f), Vec3f(0, 0.25f, -2.5f)}, 0);
  return scene;
}

/// On the floor, two pixels towards or away from the eye: as wide as an outline of a shadow is a ramp.
double ramp(const Vec3& p) {
  const double pixel = 2.0 / 512 * std::numbers::pi / 2; // radians
  return 2 * pixel * glm::dot(p, p) / std::abs(floor_height);
}

TEST(Bake, CastsShadowsOnRequest) {
  ConvertOptions options = baking();
  options.bake.shadows = true;
  ConvertReport report;
  const std::vector<Sample> shadowed = sample_floor(convert(with_plate(), options, report));
  std::size_t dark = 0, wrong = 0;
  for (const Sample& s : shadowed) {
    const double depth = depth_in_shadow(s.eye);
    if (std::abs(depth) < ramp(s.eye)) continue;
    dark += depth > 0;
    wrong += std::abs(srgb_step(s.red) - (depth > 0 ? 0 : srgb_step(light_on_floor(s.eye)))) > 6;
  }
  EXPECT_GT(dark, 30u);
  EXPECT_EQ(wrong, 0u) << "of " << shadowed.size();
  options.bake.shadows = false;
  EXPECT_LE(largest_error(convert(with_plate(), options, report)), 6);
}

TEST(Bake, ShadowsNeedBaking) {
  ConvertOptions options = baking();
  options.shading = Shading::keep;
  options.bake.shadows = true;
  ConvertReport report;
  EXPECT_THROW(convert(lit_floor(), options, report), Error);
}

TEST(Bake, RefusesACriterionWithoutAnEnd) {
  ConvertOptions options = baking();
  options.refine.criterion_px = 0;
  ConvertReport report;
  try {
    convert(lit_floor(), options, report);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_THAT(error.what(), HasSubstr("criterion_px"));
  }
}

TEST(Bake, LightsASceneWithoutLightsFromTheEye) {
  Scene scene = lit_floor();
  scene.lights.clear();
  ConvertReport report;
  for (const Sample& s : sample_floor(convert(scene, baking(), report))) {
    const double expected = 0.35 + 0.65 * std::abs(s.eye.y) / glm::length(s.eye);
    EXPECT_NEAR(srgb_step(s.red), srgb_step(expected), 6);
  }
}

TEST(Bake, GivesEachFaceOfACornerItsOwnColour) {
  Scene scene = lit_floor();
  Primitive& primitive = scene.meshes[0].primitives[0];
  primitive.positions.insert(primitive.positions.end(), {Vec3f(-4, 7, -8), Vec3f(4, 7, -8)}); // a wall on the same vertices
  primitive.indices.insert(primitive.indices.end(), {3, 2, 5, 3, 5, 4});
  ConvertReport report;
  const Scene warped = convert(scene, baking(), report);
  const Primitive& out = warped.meshes[0].primitives[0];
  const std::vector<float>&source = find_attribute(out, "_SOURCE_POSITION")->values, &colour = find_attribute(out, "COLOR_0")->values;
  const auto at = [&](std::size_t v) { return Vec3(source[3 * v], source[3 * v + 1], source[3 * v + 2]); };
  std::size_t doubled = 0;
  for (std::size_t v = 0; v < out.positions.size(); ++v)
    for (std::size_t w = 0; w < v; ++w) doubled += at(v) == at(w) && std::abs(colour[3 * v] - colour[3 * w]) > 0.01f;
  EXPECT_GT(doubled, 5u);
}

TEST(Bake, FoldsAGlowIntoTheColours) {
  Scene scene = lit_floor();
  scene.lights[0].intensity = 0;
  scene.materials[0].base_color = Vec4(0, 0, 0, 1);
  scene.materials[0].emissive = Vec3(0.25);
  scene.materials[0].json = R"({"name": "lamp", "emissiveFactor": [0.25, 0.25, 0.25]})";
  ConvertReport report;
  const Scene warped = convert(scene, baking(), report);
  EXPECT_EQ(warped.materials[0].base_color, Vec4(1));
  EXPECT_EQ(warped.materials[0].emissive, Vec3(0));
  EXPECT_EQ(warped.materials[0].json, R"({"name":"lamp","pbrMetallicRoughness":{"baseColorFactor":[1.0,1.0,1.0,1.0]}})");
  for (const Sample& s : sample_floor(warped)) EXPECT_NEAR(s.red, 0.25, 1e-6);
}

TEST(Bake, SaysWhatIsTooBright) {
  ConvertOptions options = baking();
  options.bake.exposure = 6;
  ConvertReport report;
  convert(lit_floor(), options, report);
  EXPECT_GT(report.baked.clipped_vertices, 0u);
  EXPECT_NEAR(report.baked.brightest, 64 * light_on_floor({lamp.x, floor_height, lamp.z}), 0.01 * report.baked.brightest);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("brighter than white")));
}

TEST(Bake, GivesTheSameColoursForAnyNumberOfThreads) {
  ConvertOptions options = baking();
  options.bake.shadows = true;
  const auto colours = [&](int threads) {
    const ThreadLimit limit(threads);
    ConvertReport report;
    return find_attribute(convert(with_plate(), options, report).meshes[0].primitives[0], "COLOR_0")->values;
  };
  EXPECT_EQ(colours(1), colours(2));
}

} // namespace
} // namespace domewarp
