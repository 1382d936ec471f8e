// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/picture_file.h"

#include <cmath>
#include <filesystem>
#include <random>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/render/ray_trace.h"
#include "render_scenes.h"

namespace domewarp {
namespace {

using namespace test;
namespace fs = std::filesystem;

struct PictureFileTest : testing::Test {
  fs::path folder = fs::temp_directory_path() / ("picture_file_" + std::to_string(std::random_device{}()));
  void SetUp() override { fs::create_directory(folder); }
  void TearDown() override { fs::remove_all(folder); }
};

Frame make_picture() {
  const Display display = make_display("1-r^2", 48, 32);
  Scene scene = make_room_with_board();
  scene.instances.pop_back();
  scene.instances.erase(scene.instances.begin()); // some pixels see nothing
  RayTraceOptions options;
  options.layers = Layers::all;
  return ray_trace(scene, View{}, display.surface, display.raster, options);
}

/// Rows [first, last) of a frame with every layer.
Frame rows_of(const Frame& frame, int first, int last) {
  Frame rows = make_frame(frame.width, last - first, Layers::all);
  const auto copy = [&](const auto& from, auto& to) {
    const std::size_t stride = from.size() / std::size_t(frame.height);
    std::copy_n(from.begin() + std::ptrdiff_t(stride) * first, to.size(), to.begin());
  };
  copy(frame.rgba, rows.rgba), copy(frame.position, rows.position), copy(frame.depth, rows.depth);
  copy(frame.object, rows.object), copy(frame.triangle, rows.triangle), copy(frame.light, rows.light);
  copy(frame.normal, rows.normal), copy(frame.uv, rows.uv);
  return rows;
}

void write(const fs::path& path, const Frame& frame) {
  PictureFile file(path, frame.width, frame.height);
  file.write(rows_of(frame, 0, 10));
  file.write(rows_of(frame, 10, frame.height));
  file.finish();
}

template <typename T>
std::vector<T> read_channel(const fs::path& path, const char* channel, Imf::PixelType type, std::size_t count, int width) {
  Imf::InputFile file(path.c_str());
  EXPECT_NE(file.header().channels().findChannel(channel), nullptr) << channel;
  std::vector<T> data(count);
  Imf::FrameBuffer buffer;
  buffer.insert(channel, Imf::Slice(type, reinterpret_cast<char*>(data.data()), sizeof(T), sizeof(T) * std::size_t(width)));
  file.setFrameBuffer(buffer);
  file.readPixels(0, static_cast<int>(count) / width - 1);
  return data;
}

TEST_F(PictureFileTest, PngHoldsTheColours) {
  const Frame frame = make_picture();
  write(folder / "a.png", frame);
  EXPECT_EQ(decode_image(read_file(folder / "a.png"), "a").rgba, frame.rgba);
}

TEST_F(PictureFileTest, ExrHoldsEveryLayer) {
  const Frame frame = make_picture();
  const fs::path path = folder / "a.exr";
  write(path, frame);
  const std::size_t n = frame.object.size();
  EXPECT_EQ(read_channel<std::uint32_t>(path, "objectId", Imf::UINT, n, frame.width), frame.object);
  EXPECT_EQ(read_channel<std::uint32_t>(path, "triangleId", Imf::UINT, n, frame.width), frame.triangle);
  const auto z = read_channel<float>(path, "Z", Imf::FLOAT, n, frame.width);
  const auto y = read_channel<float>(path, "P.Y", Imf::FLOAT, n, frame.width);
  const auto normal = read_channel<float>(path, "N.Z", Imf::FLOAT, n, frame.width);
  const auto v = read_channel<float>(path, "UV.V", Imf::FLOAT, n, frame.width);
  const auto red = read_channel<float>(path, "R", Imf::FLOAT, n, frame.width);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_NEAR(red[i], frame.light[i].x, 1e-3);
    if (!frame.object[i]) {
      EXPECT_TRUE(std::isnan(z[i]));
      continue;
    }
    ++hits;
    EXPECT_EQ(z[i], frame.depth[i]);
    EXPECT_EQ(y[i], frame.position[i].y);
    EXPECT_EQ(normal[i], frame.normal[i].z);
    EXPECT_EQ(v[i], frame.uv[i].y);
  }
  EXPECT_GT(hits, 100u);
  EXPECT_LT(hits, n);
}

TEST_F(PictureFileTest, NothingIsLeftUnlessFinished) {
  for (const char* name : {"a.png", "a.exr"}) {
    {
      PictureFile file(folder / name, 48, 32);
      file.write(rows_of(make_picture(), 0, 5));
    }
    EXPECT_TRUE(fs::is_empty(folder)) << name;
  }
}

TEST_F(PictureFileTest, WhatCannotBeWrittenIsRefused) {
  EXPECT_THROW(PictureFile(folder / "a.tiff", 8, 8), Error);
  EXPECT_THROW(PictureFile(folder / "missing" / "a.png", 8, 8), Error);
  EXPECT_THROW(PictureFile(folder / "missing" / "a.exr", 8, 8), Error);
}

} // namespace
} // namespace domewarp
