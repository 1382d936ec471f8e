// SPDX-License-Identifier: Apache-2.0
// Many samples where they are needed, and nowhere missed.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/render/sampling.h"
#include "render_scenes.h"

namespace domewarp {
namespace {

using namespace test;

TEST(Sampling, EveryDyadicRectangleHoldsOnePoint) {
  for (const std::uint32_t seed : {0u, 1u, 77u, 4000000000u})
    for (int across = 0; across <= 5; ++across) {
      std::set<int> boxes;
      for (std::uint32_t i = 0; i < 32; ++i) {
        const Vec2 p = sobol_point(i, seed);
        ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
        boxes.insert(int(p.x * (1 << across)) * 32 + int(p.y * (32 >> across)));
      }
      EXPECT_EQ(boxes.size(), 32u) << seed << " " << across;
    }
}

TEST(Sampling, SeedsScrambleDifferently) {
  std::set<double> first;
  for (int i = 0; i < 64; ++i) first.insert(sobol_point(0, pixel_seed(i % 8, i / 8)).x);
  EXPECT_EQ(first.size(), 64u);
}

/// A white square before black, on the flat surface z = 1 where a pixel is 2/32 wide at distance 1.
Scene make_speck(double column, double row, double size_px) {
  Scene scene;
  const int black = add_material(scene, {0, 0, 0, 1}), white = add_material(scene, {1, 1, 1, 1});
  add(scene, make_quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, black));
  const double pixel = 2.0 / 32, size = size_px * pixel;
  add(scene, make_quad({column * pixel - 1, 1 - row * pixel - size, -1}, {size, 0, 0}, {0, size, 0}, white));
  return scene;
}

Frame trace(const Scene& scene, const Display& display, int samples, bool outlines = true) {
  RayTraceOptions options;
  options.unlit = true;
  options.samples = samples;
  options.outlines = outlines;
  options.count_rays = true;
  options.layers = Layers::all;
  return ray_trace(scene, View{}, display.surface, display.raster, options);
}

double total_light(const Frame& frame) {
  double sum = 0;
  for (const Vec4f& light : frame.light) sum += double(light.x);
  return sum;
}

/// Figure 20 of the thesis: rays through neighbouring centres miss a small object, and contrast never notices.
TEST(Sampling, AnObjectBetweenTwoRaysIsFound) {
  const Display display = make_display("1", 32, 32);
  for (const double size : {0.3, 0.6, 0.9}) {
    const Scene scene = make_speck(20.55, 9.55, size); // between the centres 20.5 and 21.5
    EXPECT_EQ(total_light(trace(scene, display, 1)), 0);
    EXPECT_EQ(total_light(trace(scene, display, 32, false)), 0) << "the thesis misses it, or this test shows nothing";
    const Frame found = trace(scene, display, 256);
    EXPECT_NEAR(total_light(found), size * size, 0.02) << size;
  }
}

TEST(Sampling, AWireThinnerThanAPixelHasNoGaps) {
  const Display display = make_display("1-r^2", 64, 64);
  Scene scene;
  const int black = add_material(scene, {0, 0, 0, 1}), white = add_material(scene, {1, 1, 1, 1});
  add(scene, make_quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, black));
  add(scene, make_quad({-0.4, -0.2, -1}, {0.8, 0.31, 0}, {0, 0.004, 0}, white)); // about 0.1 px
  const Frame frame = trace(scene, display, 64);
  int dark = 0, columns = 0;
  for (int column = 24; column < 40; ++column, ++columns) {
    double sum = 0;
    for (int row = 0; row < 64; ++row) sum += double(frame.light[std::size_t(row * 64 + column)].x);
    dark += sum < 0.03;
  }
  EXPECT_EQ(dark, 0) << "of " << columns;
}

TEST(Sampling, WhatIsHiddenCostsNothing) {
  const Display display = make_display("1", 32, 32);
  Scene scene = make_speck(20.55, 9.55, 0.5);
  add(scene, make_quad({-9, -9, -0.5}, {18, 0, 0}, {0, 18, 0}, 1));
  for (const std::uint16_t rays : trace(scene, display, 32).rays) EXPECT_EQ(rays, 1);
}

TEST(Sampling, OnlyEdgesTakeManyRays) {
  const Display display = make_display("1", 32, 32);
  const Frame frame = trace(make_speck(8.25, 8.25, 12), display, 16);
  EXPECT_EQ(frame.rays[16 * 32 + 14], 1) << "inside";
  EXPECT_EQ(frame.rays[2 * 32 + 2], 1) << "outside";
  EXPECT_EQ(frame.rays[14 * 32 + 8], 17) << "on the edge";
  EXPECT_NEAR(frame.light[14 * 32 + 8].x, 0.75, 0.07) << "its coverage";
  EXPECT_NEAR(total_light(trace(make_speck(8.25, 8.25, 12), display, 64)), 144, 0.5);
}

TEST(Sampling, TheHotSpotPictureIsDarkWhereRaysWent) {
  const Display display = make_display("1", 32, 32);
  const Pixels picture = hot_spot_picture(trace(make_speck(8.25, 8.25, 12), display, 16), 17);
  EXPECT_EQ(picture.rgba[4 * (16 * 32 + 14)], 255);
  EXPECT_EQ(picture.rgba[4 * (14 * 32 + 8)], 0);
}

TEST(Sampling, BandsMakeTheSamePicture) {
  const Display display = make_display("1-r^2", 64, 500);
  RayTraceOptions options;
  options.samples = 4;
  const Frame whole = ray_trace(make_room_with_board(), View{}, display.surface, display.raster, options);
  std::vector<std::uint8_t> rgba;
  int rows = 0;
  ray_trace(make_room_with_board(), View{}, display.surface, display.raster, options, [&](const Frame& band, int top) {
    EXPECT_EQ(top, rows);
    rows += band.height;
    rgba.insert(rgba.end(), band.rgba.begin(), band.rgba.end());
  });
  EXPECT_EQ(rows, 500);
  EXPECT_EQ(rgba, whole.rgba);
}

TEST(Sampling, NumbersOutOfRangeAreRefused) {
  const Display display = make_display("1", 8, 8);
  EXPECT_THROW(trace(make_room(), display, 0), Error);
  EXPECT_THROW(trace(make_room(), display, 5000), Error);
}

} // namespace
} // namespace domewarp
