// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/rasterise.h"

#include <cmath>
#include <numbers>

#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "render_scenes.h"

namespace domewarp {
namespace {

using namespace test;

const Raster square{64, 64};

/// A camera at the origin that sees 90 degrees.
Camera make_camera() {
  Camera camera;
  camera.yfov = std::numbers::pi / 2;
  camera.znear = 0.1;
  camera.zfar = 100;
  return camera;
}

Scene with_camera(Scene scene) {
  scene.cameras = {make_camera()};
  return scene;
}

std::size_t at(int column, int row) {
  return std::size_t(row) * 64 + std::size_t(column);
}

TEST(Rasterise, DrawsThroughTheCameraOfTheFileTheRightWayUp) {
  Scene scene = with_camera({});
  const int red = add_material(scene, {1, 0, 0, 1});
  add(scene, make_quad({0, 0, -2}, {2, 0, 0}, {0, 2, 0}, red)); // fills the upper right quarter
  const Frame frame = rasterise(scene, square, {});
  for (int row = 0; row < 64; ++row)
    for (int column = 0; column < 64; ++column)
      EXPECT_EQ(frame.object[at(column, row)], column >= 32 && row < 32 ? 1u : 0u) << column << " " << row;
  EXPECT_GT(frame.rgba[4 * at(40, 10)], 200);
  EXPECT_EQ(frame.rgba[4 * at(10, 40) + 3], 0);
  EXPECT_FALSE(frame.renderer.empty());
  EXPECT_TRUE(std::isnan(frame.depth[at(40, 10)])) << "no _SOURCE_POSITION";
}

TEST(Rasterise, MovingCameraAndObjectTogetherChangesNothing) {
  Scene scene = with_camera(make_room_with_board());
  const Frame still = rasterise(scene, square, {});
  // A power of two and a quarter turn keep every position exact.
  Mat4 move(1);
  move[0] = {0, 0, -1, 0};
  move[2] = {1, 0, 0, 0};
  move[3] = {16, -8, 4, 1};
  scene.cameras[0].world = move;
  for (Instance& instance : scene.instances) instance.world = move * instance.world;
  EXPECT_EQ(count_object_differences(still, rasterise(scene, square, {})), 0u);
}

TEST(Rasterise, AnOrthographicCameraShowsItsExtent) {
  Scene scene;
  Camera camera;
  camera.perspective = false;
  camera.xmag = camera.ymag = 4;
  camera.zfar = 10;
  scene.cameras = {camera};
  add(scene, make_quad({-2, -1, -5}, {4, 0, 0}, {0, 2, 0}, -1));
  const Frame frame = rasterise(scene, square, {});
  for (int row = 0; row < 64; ++row)
    for (int column = 0; column < 64; ++column)
      EXPECT_EQ(frame.object[at(column, row)] != 0, column >= 16 && column < 48 && row >= 24 && row < 40);
}

TEST(Rasterise, WhatLiesExactlyOnTheNearAndFarPlanesIsDrawn) {
  for (const double z : {0.5, 3.0})
    for (const bool perspective : {true, false}) {
      Scene scene = with_camera({});
      scene.cameras[0].perspective = perspective;
      scene.cameras[0].ymag = 1;
      scene.cameras[0].znear = 0.5;
      scene.cameras[0].zfar = 3;
      add(scene, make_quad({-9, -9, -z}, {18, 0, 0}, {0, 18, 0}, -1));
      EXPECT_EQ(rasterise(scene, square, {}).object[at(20, 20)], 1u) << z;
    }
}

TEST(Rasterise, AnInfiniteCameraSeesFarThings) {
  Scene scene = with_camera({});
  scene.cameras[0].zfar = 0;
  add(scene, make_quad({-9e6, -9e6, -1e6}, {18e6, 0, 0}, {0, 18e6, 0}, -1));
  EXPECT_EQ(rasterise(scene, square, {}).object[at(20, 20)], 1u);
}

TEST(Rasterise, BackFacesOfSingleSidedMaterialsAreNotDrawn) {
  Scene scene = with_camera({});
  add_material(scene, Vec4(1), AlphaMode::opaque, true);
  add(scene, make_quad({9, -9, -1}, {-18, 0, 0}, {0, 18, 0}, -1));
  EXPECT_EQ(rasterise(scene, square, {}).object[at(32, 32)], 0u);
  scene.meshes[0].primitives[0].material = 0;
  EXPECT_EQ(rasterise(scene, square, {}).object[at(32, 32)], 1u);
  scene.meshes[0].primitives[0].material = -1;
  scene.instances[0].world[0][0] = -1;
  EXPECT_EQ(rasterise(scene, square, {}).object[at(32, 32)], 1u) << "the winding in world space decides";
}

TEST(Rasterise, TilesMakeTheSamePicture) {
  const Display display = make_display("1-r^2", 300, 210);
  Scene source = make_room_with_board();
  add_texture(source, 2, 10497, 9729);
  const Scene scene = prewarp(source, display, 16);
  RasterOptions options;
  const Frame whole = rasterise(scene, display.raster, options);
  for (const int tile : {32, 50, 101}) {
    options.tile = tile;
    const Frame tiled = rasterise(scene, display.raster, options);
    EXPECT_EQ(whole.object, tiled.object);
    EXPECT_EQ(whole.triangle, tiled.triangle);
    // What is interpolated starts from the tile's corner, and is rounded there.
    std::size_t other_bytes = 0;
    for (std::size_t i = 0; i < whole.rgba.size(); ++i) other_bytes += whole.rgba[i] != tiled.rgba[i];
    EXPECT_LE(other_bytes, 60u) << "of 252000, tiles of " << tile;
    for (std::size_t i = 0; i < whole.rgba.size(); ++i) ASSERT_NEAR(whole.rgba[i], tiled.rgba[i], 1) << i;
    for (std::size_t i = 0; i < whole.depth.size(); ++i) ASSERT_NEAR(whole.depth[i], tiled.depth[i], 5e-6) << i;
  }
}

template <typename T>
void append(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

/// Wider than any driver draws at once, and in several bands.
TEST(Rasterise, BandsMakeTheSamePicture) {
  const Display display = make_display("1-r^2", 17000, 500);
  const Scene scene = prewarp(make_room_with_board(), display, 16);
  const Frame whole = rasterise(scene, display.raster, {});
  Frame joined;
  int bands = 0;
  rasterise(scene, display.raster, {}, [&](const Frame& band, int top) {
    EXPECT_EQ(top, joined.height);
    joined.height += band.height;
    ++bands;
    append(joined.rgba, band.rgba);
    append(joined.position, band.position);
    append(joined.depth, band.depth);
    append(joined.drawn_depth, band.drawn_depth);
    append(joined.object, band.object);
    append(joined.triangle, band.triangle);
  });
  EXPECT_GT(bands, 1);
  joined.width = whole.width;
  EXPECT_TRUE(is_same(whole, joined));
}

TEST(Rasterise, SupersamplesAreCoverage) {
  Scene scene = with_camera({});
  add(scene, make_quad({0.25 / 32, -9, -1}, {9, 0, 0}, {0, 18, 0}, add_material(scene, Vec4(1)))); // a quarter px late
  RasterOptions options;
  options.unlit = true;
  options.supersample = 4;
  options.layers = Layers::all;
  const Frame frame = rasterise(scene, square, options);
  EXPECT_EQ(frame.light[at(31, 20)].w, 0);
  EXPECT_EQ(frame.light[at(32, 20)].w, 0.75f);
  EXPECT_EQ(frame.light[at(33, 20)].w, 1);
  options.supersample = 1;
  EXPECT_EQ(rasterise(scene, square, options).object, frame.object) << "ids are those of the centres";
  options.supersample = 17;
  EXPECT_THROW(rasterise(scene, square, options), Error);
}

TEST(Rasterise, BothProjectionsShowTheSamePicture) {
  const Display display = make_display("1-r^2", 120, 80);
  const Scene scene = make_room_with_board();
  const Frame a = rasterise(prewarp(scene, display, 64, Output::perspective), display.raster, {});
  const Frame b = rasterise(prewarp(scene, display, 64, Output::orthographic), display.raster, {});
  EXPECT_LE(count_object_differences(a, b), 12u) << "of some 500 px of outline";
  int worst = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    if (a.object[i / 4] == b.object[i / 4]) worst = std::max(worst, std::abs(int(a.rgba[i]) - int(b.rgba[i])));
  EXPECT_LE(worst, 2);
  const Frame c = rasterise(prewarp(scene, display, 1, Output::orthographic), display.raster, {});
  EXPECT_GT(count_object_differences(a, c), 100u) << "coarse geometry is another picture";
}

TEST(Rasterise, PointsAndLinesAreColoursOnly) {
  Scene scene = with_camera({});
  Primitive line;
  line.topology = Topology::lines;
  line.positions = {{-9, 0.01f, -1}, {9, 0.01f, -1}};
  line.indices = {0, 1};
  Primitive point;
  point.topology = Topology::points;
  point.positions = {{0.51f, 0.51f, -1}};
  point.indices = {0};
  add(scene, {"strokes", {line, point}});
  const Frame frame = rasterise(scene, square, {});
  EXPECT_EQ(frame.rgba[4 * at(40, 31)], 255);
  EXPECT_EQ(frame.rgba[4 * at(48, 15)], 255);
  EXPECT_EQ(frame.rgba[4 * at(40, 29)], 0);
  EXPECT_EQ(frame.object[at(40, 31)], 0u);
}

TEST(Rasterise, DrawsThroughTheCameraThatIsAskedFor) {
  Scene scene = with_camera(make_room());
  scene.cameras.push_back(make_camera());
  scene.cameras[1].world = glm::rotate(Mat4(1), 1.0, Vec3(0, 1, 0));
  RasterOptions options;
  const Frame first = rasterise(scene, square, options);
  options.camera = 1;
  EXPECT_GT(count_object_differences(first, rasterise(scene, square, options)), 500u);
  options.camera = 2;
  EXPECT_THROW(rasterise(scene, square, options), Error);
  EXPECT_GE(first.subpixel_bits, 4);
}

TEST(Rasterise, TheSameSceneMakesTheSameBytes) {
  const Display display = make_display("1-r^2", 64, 64);
  const Scene scene = prewarp(make_room_with_board(), display, 8);
  EXPECT_TRUE(is_same(rasterise(scene, display.raster, {}), rasterise(scene, display.raster, {})));
}

TEST(Rasterise, BlendedTrianglesAreSortedAndNotedByTheNearest) {
  Scene scene = with_camera({});
  const int red = add_material(scene, {1, 0, 0, 0.5}, AlphaMode::blend);
  const int green = add_material(scene, {0, 1, 0, 0.5}, AlphaMode::blend);
  const int blue = add_material(scene, {0, 0, 1, 1});
  add(scene, make_quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}, red));
  add(scene, make_quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, green));
  add(scene, make_quad({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, blue));
  RasterOptions options;
  options.unlit = true;
  const Frame frame = rasterise(scene, square, options);
  const std::size_t centre = at(32, 32);
  EXPECT_EQ(frame.object[centre], 1u);
  EXPECT_NEAR(frame.rgba[4 * centre], 188, 1);
  EXPECT_NEAR(frame.rgba[4 * centre + 1], 137, 1);
  EXPECT_NEAR(frame.rgba[4 * centre + 2], 137, 1);
}

TEST(Rasterise, TriangleIdsCountAcrossPrimitives) {
  Scene scene = with_camera({});
  Mesh mesh = make_quad({-9, -9, -2}, {9, 0, 0}, {0, 18, 0}, -1);
  mesh.primitives.push_back(make_quad({0, -9, -2}, {9, 0, 0}, {0, 18, 0}, add_material(scene, Vec4(1))).primitives[0]);
  add(scene, mesh);
  const Frame frame = rasterise(scene, square, {});
  EXPECT_EQ(frame.triangle[at(40, 62)], 4u);
  EXPECT_EQ(frame.triangle[at(1, 32)], 1u);
}

TEST(Rasterise, CamerasThatShowNothingAreRefused) {
  EXPECT_THROW(rasterise(make_room(), square, {}), Error);
  const auto refuses = [](auto&& change) {
    Scene scene = with_camera(make_room());
    change(scene.cameras[0]);
    EXPECT_THROW(rasterise(scene, square, {}), Error);
  };
  refuses([](Camera& c) { c.znear = 0; });
  refuses([](Camera& c) { c.zfar = 0.05; });
  refuses([](Camera& c) { c.yfov = 4; });
  refuses([](Camera& c) { c.world = Mat4(0); });
  refuses([](Camera& c) { c.perspective = false; });
  EXPECT_THROW(rasterise(with_camera({}), Raster{0, 4}, {}), Error);
}

TEST(Rasterise, BrokenVerticesAreHarmless) {
  for (const float size : {1e30f, 3e38f, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    Scene scene = with_camera(make_room());
    scene.meshes[0].primitives[0].positions[2] = {size, size, -size};
    EXPECT_NO_THROW(rasterise(scene, square, {})) << size;
  }
}

} // namespace
} // namespace domewarp
