// SPDX-License-Identifier: Apache-2.0
// Rays on the original scene against OpenGL on the pre-warped one: objects and positions first, colours second.
#include <cmath>
#include <cstdlib>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "render_scenes.h"

namespace domewarp {
namespace {

using namespace test;

struct Pair {
  Frame rays, gl;
};

Pair render(const Scene& scene, const Display& display, int divisions, Output output = Output::perspective) {
  return {ray_trace(scene, View{}, display.surface, display.raster, {}),
          rasterise(prewarp(scene, display, divisions, output), display.raster, {})};
}

/// Largest difference of a colour byte away from outlines.
int colour_difference(const Pair& pair) {
  int worst = 0;
  for (int row = 0; row < pair.rays.height; ++row)
    for (int column = 0; column < pair.rays.width; ++column) {
      if (is_outline(pair.rays, column, row)) continue;
      const std::size_t i = std::size_t(row * pair.rays.width + column);
      for (std::size_t k = 4 * i; k < 4 * i + 4; ++k)
        worst = std::max(worst, std::abs(int(pair.rays.rgba[k]) - int(pair.gl.rgba[k])));
    }
  return worst;
}

/// Pixels covered in both pictures whose colour differs by more than that.
std::size_t count_colour_differences(const Pair& pair, int most) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < pair.rays.object.size(); ++i) {
    int worst = 0;
    for (std::size_t k = 4 * i; k < 4 * i + 3; ++k)
      worst = std::max(worst, std::abs(int(pair.rays.rgba[k]) - int(pair.gl.rgba[k])));
    count += worst > most && pair.rays.object[i] && pair.gl.object[i];
  }
  return count;
}

void expect_same_objects_and_positions(const Pair& pair, double tolerance) {
  for (int row = 0; row < pair.rays.height; ++row)
    for (int column = 0; column < pair.rays.width; ++column) {
      if (is_outline(pair.rays, column, row)) continue;
      const std::size_t i = std::size_t(row * pair.rays.width + column);
      ASSERT_EQ(pair.rays.object[i], pair.gl.object[i]) << column << " " << row;
      const double off = glm::length(Vec3(pair.rays.position[i]) - Vec3(pair.gl.position[i]));
      ASSERT_LT(off, tolerance * pair.rays.depth[i]) << column << " " << row;
    }
}

TEST(Parity, BothRenderersSeeTheSameRoom) {
  for (const char* curve : {"1-r^2", "3-sqrt(4+6*r^2)", "1"})
    for (const Output output : {Output::perspective, Output::orthographic}) {
      const Display display = make_display(curve, 120, 80);
      const Pair pair = render(make_room_with_board(), display, 48, output);
      // A tenth of a pixel is 2.5e-3 in the image; the slant at which walls are seen makes more of it.
      expect_same_objects_and_positions(pair, 0.01);
      EXPECT_LE(colour_difference(pair), 2) << curve;
    }
}

/// The surface z = 1 is an ordinary camera, so the scene itself needs no warp to be drawn right.
TEST(Parity, AFlatSurfaceIsAnOrdinaryCamera) {
  const Display display = make_display("1", 120, 80);
  Scene scene = make_room_with_board();
  const Frame rays = ray_trace(scene, View{}, display.surface, display.raster, {});
  Camera camera;
  camera.yfov = std::acos(0.0);
  camera.znear = 0.1;
  scene.cameras = {camera};
  const Frame gl = rasterise(scene, display.raster, {});
  // Some 500 pixels of outline, drawn to 1/256 px by the rasteriser.
  EXPECT_LE(count_object_differences(rays, gl), 8u);
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < gl.triangle.size(); ++i) triangles += rays.triangle[i] != gl.triangle[i];
  EXPECT_LE(triangles, 10u);
  EXPECT_LE(colour_difference({rays, gl}), 1);
}

TEST(Parity, CoarseGeometryIsNoticed) {
  const Display display = make_display("1-r^2", 120, 80);
  const Pair pair = render(make_room(), display, 2);
  double worst = 0;
  for (std::size_t i = 0; i < pair.rays.object.size(); ++i)
    if (pair.rays.object[i] == pair.gl.object[i])
      worst = std::max(worst, glm::length(Vec3(pair.rays.position[i]) - Vec3(pair.gl.position[i])));
  EXPECT_GT(worst, 0.1);
}

class ParityOfTextures : public testing::TestWithParam<std::pair<int, int>> {};

/// Large texels keep the difference of positions from showing; nearest texels may still differ along their edges.
TEST_P(ParityOfTextures, BothRenderersReadTheSameTexels) {
  const auto [wrap, filter] = GetParam();
  const Display display = make_display("1-r^2", 120, 120);
  Scene scene;
  const int material = add_material(scene, Vec4(1));
  add_texture(scene, material, wrap, filter, 4);
  TextureReference& reference = scene.materials[0].base_texture;
  reference.offset = {-1.1, 0.3};
  reference.rotation = 0.4;
  reference.scale = {1.2, 0.9};
  add(scene, make_quad({-3, -3, -1.5}, {6, 0, 0}, {0, 6, 0.5}, material, 2.7));
  const Pair pair = render(scene, display, 128);
  EXPECT_LE(count_colour_differences(pair, 3), filter == 9728 ? 60u : 0u);
}

INSTANTIATE_TEST_SUITE_P(WrapAndFilter, ParityOfTextures,
                         testing::Values(std::pair(10497, 9728), std::pair(33071, 9728), std::pair(33648, 9728),
                                         std::pair(10497, 9729), std::pair(33071, 9729), std::pair(33648, 9729)));

TEST(Parity, MaskVertexColoursNormalsAndGlowAgree) {
  const Display display = make_display("1-r^2", 96, 96);
  Scene scene;
  const int material = add_material(scene, {0.9, 0.8, 0.7, 1}, AlphaMode::mask, true);
  scene.materials[0].emissive = {0.02, 0.05, 0.1};
  Mesh quad = make_quad({3, -3, -1.5}, {-6, 0, 0}, {0, 6, 0.5}, material);
  quad.primitives[0].attributes.push_back({"COLOR_0", 4, {1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 0.3f}});
  quad.primitives[0].attributes.push_back({"NORMAL", 3, {0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 1}});
  add(scene, quad);
  const Pair pair = render(scene, display, 64);
  std::size_t covered = 0;
  for (const std::uint32_t object : pair.rays.object) covered += object != 0;
  EXPECT_GT(covered, 1000u);
  EXPECT_LT(covered, 8000u);
  EXPECT_LE(count_object_differences(pair.rays, pair.gl), 20u);
  EXPECT_LE(colour_difference(pair), 2);
}

TEST(Parity, BlendedPanesAgree) {
  const Display display = make_display("1-r^2", 96, 96);
  Scene scene = make_room();
  const int red = add_material(scene, {1, 0, 0, 0.4}, AlphaMode::blend, true);
  const int green = add_material(scene, {0, 1, 0, 0.6}, AlphaMode::blend, true);
  add(scene, make_quad({-0.5, -0.5, -1}, {1, 0, 0}, {0, 1, 0}, red)); // its diagonal runs through pixel centres
  add(scene, make_quad({-0.2, -0.2, -1.5}, {1, 0, 0}, {0, 1, 0}, green));
  const Pair pair = render(scene, display, 64);
  expect_same_objects_and_positions(pair, 0.01);
  // Outlines seen through a pane may fall on the other side of a pixel centre.
  EXPECT_LE(count_colour_differences(pair, 3), 10u);
}

} // namespace
} // namespace domewarp
