// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/ray_trace.h"

#include <cmath>
#include <cstdlib>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/scene/test_scenes.h"
#include "render_scenes.h"

namespace domewarp {
namespace {

using namespace test;

const std::string bowl = "1-r^2";

Frame trace(const Scene& scene, const Display& display, RayTraceOptions options = {}) {
  return ray_trace(scene, View{}, display.surface, display.raster, options);
}

/// A crowd of small random triangles around the eye, many with common vertices.
Scene make_crowd(int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coordinate(-2, 2);
  Primitive crowd;
  for (int i = 0; i < count; ++i)
    crowd.positions.push_back({coordinate(random), coordinate(random), coordinate(random)});
  for (int i = 0; i < 6 * count; ++i) crowd.indices.push_back(static_cast<std::uint32_t>(random() % unsigned(count)));
  Scene scene;
  add_material(scene, Vec4(1), AlphaMode::opaque, true);
  crowd.material = 0;
  add(scene, {"crowd", {crowd}});
  return scene;
}

TEST(RayTrace, EveryPixelOfARoomIsHitInTheRightDirection) {
  const Display display = make_display(bowl, 96, 64);
  const Frame frame = trace(make_room(), display);
  for (int row = 0; row < 64; ++row)
    for (int column = 0; column < 96; ++column) {
      const std::size_t i = std::size_t(row * 96 + column);
      Vec3 direction;
      ASSERT_TRUE(unproject(display.surface, pixel_centre(display.raster, column, row), direction));
      ASSERT_NE(frame.object[i], 0u);
      EXPECT_LT(glm::length(Vec3(frame.position[i]) / double(frame.depth[i]) - direction), 1e-6);
    }
}

TEST(RayTrace, BeyondTheLargestRadiusThereIsBackground) {
  SurfaceOptions options;
  options.curve = bowl;
  options.rmax = 0.5;
  const Raster raster{40, 40};
  const Surface surface(options, screen_radius(raster));
  RayTraceOptions trace_options;
  trace_options.background = {1, 2, 3, 255};
  const Frame frame = ray_trace(make_room(), View{}, surface, raster, trace_options);
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 40; ++column) {
      const std::size_t i = std::size_t(row * 40 + column);
      const bool inside = glm::length(pixel_centre(raster, column, row)) <= 0.5;
      EXPECT_EQ(frame.object[i] != 0, inside);
      EXPECT_EQ(std::isnan(frame.depth[i]), !inside);
      if (!inside) {
        EXPECT_EQ(frame.rgba[4 * i + 2], 3);
      }
    }
}

TEST(RayTrace, TheNearerSurfaceHidesTheFarther) {
  const Display display = make_display(bowl, 64, 64);
  Scene scene;
  add(scene, make_quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, -1));
  add(scene, make_quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}, -1));
  const Frame frame = trace(scene, display);
  EXPECT_EQ(frame.object[32 * 64 + 32], 2u);
  EXPECT_NEAR(frame.position[32 * 64 + 32].z, -1, 1e-7);
}

TEST(RayTrace, AmongEquallyNearTrianglesTheFirstIsSeen) {
  const Display display = make_display(bowl, 64, 64);
  Scene scene;
  for (int i = 0; i < 3; ++i) add(scene, make_quad({-9, -8, -1.7}, {18, 1, 2}, {-1, 18, 0}, -1));
  const Frame frame = trace(scene, display);
  for (std::size_t i = 0; i < frame.object.size(); ++i)
    if (frame.object[i]) {
      ASSERT_EQ(frame.object[i], 1u) << i;
    }
}

TEST(RayTrace, BackFacesOfSingleSidedMaterialsAreNotSeen) {
  const Display display = make_display(bowl, 32, 32);
  const std::size_t centre = 16 * 32 + 16;
  Scene scene;
  add_material(scene, Vec4(1), AlphaMode::opaque, true);
  add(scene, make_quad({9, -9, -1}, {-18, 0, 0}, {0, 18, 0}, -1));
  EXPECT_EQ(trace(scene, display).object[centre], 0u);
  scene.meshes[0].primitives[0].material = 0;
  EXPECT_EQ(trace(scene, display).object[centre], 1u);
  scene.meshes[0].primitives[0].material = -1;
  scene.instances[0].world[0][0] = -1;
  EXPECT_EQ(trace(scene, display).object[centre], 1u) << "the winding in world space decides";
}

TEST(RayTrace, MaskedTexelsAreHoles) {
  const Display display = make_display(bowl, 64, 64);
  Scene scene;
  const int material = add_material(scene, Vec4(1), AlphaMode::mask);
  Mesh quad = make_quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}, material);
  quad.primitives[0].attributes.push_back({"COLOR_0", 4, {1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0}});
  add(scene, quad);
  const Frame frame = trace(scene, display);
  EXPECT_EQ(frame.object[32 * 64 + 28], 0u);
  EXPECT_EQ(frame.object[32 * 64 + 35], 1u);
}

TEST(RayTrace, BlendedSurfacesAreComposedFrontToBack) {
  const Display display = make_display(bowl, 32, 32);
  const std::size_t centre = 16 * 32 + 16;
  Scene scene;
  const int red = add_material(scene, {1, 0, 0, 0.5}, AlphaMode::blend);
  const int green = add_material(scene, {0, 1, 0, 0.5}, AlphaMode::blend);
  const int blue = add_material(scene, {0, 0, 1, 1});
  add(scene, make_quad({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, blue));
  add(scene, make_quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}, red));
  add(scene, make_quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, green));
  RayTraceOptions options;
  options.unlit = true;
  const Frame frame = trace(scene, display, options);
  EXPECT_EQ(frame.object[centre], 2u);
  EXPECT_NEAR(frame.rgba[4 * centre], 188, 1);     // sRGB of 1/2
  EXPECT_NEAR(frame.rgba[4 * centre + 1], 137, 1); // of 1/4
  EXPECT_NEAR(frame.rgba[4 * centre + 2], 137, 1);
}

TEST(RayTrace, NothingIsHitNearerThanTheNearDistance) {
  const Display display = make_display(bowl, 32, 32);
  Scene scene;
  add(scene, make_quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}, -1));
  RayTraceOptions options;
  options.near = 1.01;
  const Frame frame = trace(scene, display, options);
  EXPECT_EQ(frame.object[16 * 32 + 16], 0u);
  EXPECT_EQ(frame.object[16 * 32 + 2], 1u);
}

TEST(RayTrace, RaysThroughSharedEdgesAndVerticesFindNoGap) {
  // The pixel centres of an odd raster lie on the axes, where the edges of this fan are.
  const Display display = make_display("1", 33, 33);
  Primitive fan;
  fan.positions = {{0, 0, -1},  {9, 0, -1},   {9, 9, -1},  {0, 9, -1}, {-9, 9, -1},
                   {-9, 0, -1}, {-9, -9, -1}, {0, -9, -1}, {9, -9, -1}};
  for (std::uint32_t i = 1; i <= 8; ++i) fan.indices.insert(fan.indices.end(), {0, i, i % 8 + 1});
  Scene scene;
  add(scene, {"fan", {fan}});
  const Frame frame = trace(scene, display);
  for (std::size_t i = 0; i < frame.object.size(); ++i) EXPECT_EQ(frame.object[i], 1u) << i;
  EXPECT_EQ(frame.triangle[16 * 33 + 16], 1u);
  EXPECT_EQ(frame.triangle[16 * 33 + 20], 1u) << "on the edge of triangles 1 and 8";
}

TEST(RayTrace, TheFrameDoesNotDependOnTheInstructionSet) {
  const Display display = make_display(bowl, 128, 128);
  const Scene scene = make_crowd(400);
  RayTraceOptions options;
  options.embree = "isa=sse2";
  const Frame reference = trace(scene, display, options);
  for (const std::string isa : {"sse4.2", "avx", "avx2", "avx512"}) {
    options.embree = "isa=" + isa;
    EXPECT_TRUE(is_same(reference, trace(scene, display, options))) << isa;
  }
}

TEST(RayTrace, TexturesBlendingAndSamplesDoNotDependOnTheInstructionSet) {
  const Display display = make_display(bowl, 96, 96);
  Scene scene = make_crowd(200);
  add_texture(scene, 0, 10497, 9729);
  add(scene, make_quad({-9, -9, -0.5}, {18, 0, 0}, {0, 18, 0}, add_material(scene, {1, 0, 0, 0.4}, AlphaMode::blend)));
  RayTraceOptions options;
  options.samples = 8;
  options.embree = "isa=sse4.2";
  const Frame reference = trace(scene, display, options);
  for (const std::string isa : {"avx2", "avx512"}) {
    options.embree = "isa=" + isa;
    EXPECT_TRUE(is_same(reference, trace(scene, display, options))) << isa;
  }
}

/// DOMEWARP_ISA_ROWS=4096 traces pictures of that many rows.
TEST(RayTrace, BundledScenesDoNotDependOnTheInstructionSet) {
  const char* text = std::getenv("DOMEWARP_ISA_ROWS");
  const int rows = text ? std::atoi(text) : 96;
  for (const std::string curve : {"1-r^2", "3-sqrt(4+6*r^2)"}) {
    const Display display = make_display(curve, rows, rows);
    for (const TestScene& test : make_test_scenes()) {
      RayTraceOptions options;
      options.embree = "isa=sse4.2";
      const View view = resolve_view(test.scene, {});
      const Frame reference = ray_trace(test.scene, view, display.surface, display.raster, options);
      for (const std::string isa : {"avx2", "avx512"}) {
        options.embree = "isa=" + isa;
        EXPECT_TRUE(is_same(reference, ray_trace(test.scene, view, display.surface, display.raster, options))) << test.name << ", " << isa;
      }
    }
  }
}

TEST(RayTrace, TheFrameDoesNotDependOnTheNumberOfThreads) {
  const Display display = make_display(bowl, 128, 128);
  const Scene scene = make_crowd(300);
  const Frame many = trace(scene, display);
  const ThreadLimit limit(1);
  EXPECT_TRUE(is_same(many, trace(scene, display)));
}

TEST(RayTrace, OtherTrianglesMakeAnotherFrame) {
  const Display display = make_display(bowl, 64, 64);
  EXPECT_FALSE(is_same(trace(make_crowd(300), display), trace(make_crowd(299), display)));
}

TEST(RayTrace, HugeTinyAndBrokenVerticesAreHarmless) {
  const Display display = make_display(bowl, 32, 32);
  for (const float size :
       {1e-30f, 1e-12f, 1e12f, 1e30f, 3e38f, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    Scene scene = make_room();
    scene.meshes[0].primitives[0].positions[2] = {size, size, -size};
    scene.meshes[1].primitives[0].positions[0] = {-size, size, 0};
    EXPECT_NO_THROW(trace(scene, display)) << size;
  }
}

TEST(RayTrace, AnEmptySceneIsBackground) {
  const Display display = make_display(bowl, 8, 8);
  const Frame frame = trace(Scene{}, display);
  for (const std::uint32_t object : frame.object) EXPECT_EQ(object, 0u);
}

TEST(RayTrace, ABrokenImageIsDrawnWhiteWithAWarning) {
  const Display display = make_display(bowl, 8, 8);
  Scene scene = make_room();
  add_texture(scene, 0, 10497, 9729);
  EXPECT_TRUE(trace(scene, display).warnings.empty());
  scene.images[0].bytes.resize(20);
  const Frame broken = trace(scene, display);
  EXPECT_EQ(broken.warnings.size(), 1u);
  EXPECT_EQ(broken.rgba, trace(make_room(), display).rgba);
}

TEST(RayTrace, WrongIndicesAreRefused) {
  const Display display = make_display(bowl, 8, 8);
  Scene scene = make_room();
  scene.meshes[2].primitives[0].indices[3] = 4;
  EXPECT_THROW(trace(scene, display), Error);
  scene = make_room();
  scene.meshes[2].primitives[0].material = 77;
  EXPECT_THROW(trace(scene, display), Error);
  scene = make_room();
  scene.instances[1].mesh = -1;
  EXPECT_THROW(trace(scene, display), Error);
}

} // namespace
} // namespace domewarp
