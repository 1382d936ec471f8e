// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include <glm/geometric.hpp>

#include "domewarp/convert/packing_error.h"
#include "domewarp/gltf/read.h"

namespace domewarp {
namespace {

/// Warped vertices from 0.05 to 20 units deep, numbered so that a compressed file can be compared with it.
Scene strewn(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> image(-1, 1), depth(-3, 3);
  Primitive primitive;
  Attribute number{"_NUMBER", 1, {}};
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const float w = std::exp(depth(random));
    primitive.positions.push_back({w * image(random), w * image(random), -w});
    number.values.push_back(static_cast<float>(i));
    primitive.indices.push_back(i);
  }
  primitive.attributes = {number};
  Scene scene;
  scene.meshes.push_back({"strewn", {primitive}});
  scene.instances.push_back({"strewn", 0, Mat4(1)});
  return scene;
}

Scene reread(const Scene& scene, const WriteOptions& options) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / ("packing_error_" + std::to_string(::getpid()) + ".glb");
  write_scene(scene, path, options);
  Scene again = read_scene(path);
  std::filesystem::remove(path);
  return again;
}

Vec2 shown(const Vec3& p, Projection projection) {
  return projection == Projection::orthographic ? Vec2(p.x, p.y) : Vec2(p.x, p.y) / -p.z;
}

/// The largest displacement between two files of the same vertices, pixels.
double displacement(const Scene& plain, const Scene& packed, Projection projection, const Raster& raster) {
  const Primitive& before = plain.meshes[0].primitives[0];
  const Primitive& after = packed.meshes[0].primitives[0];
  double largest = 0;
  for (std::size_t i = 0; i < after.positions.size(); ++i) {
    const auto number = static_cast<std::size_t>(after.attributes[0].values[i]);
    const Vec3 moved = Vec3(packed.instances[0].world * Vec4(Vec3(after.positions[i]), 1));
    largest = std::max(largest, glm::length(shown(moved, projection) - shown(Vec3(before.positions[number]), projection)));
  }
  return largest / pixel_size(raster);
}

TEST(PackingError, BoundsWhatAReaderSees) {
  const Raster raster{2048, 2048};
  for (const unsigned seed : {1u, 2u, 3u})
    for (const WriteOptions write : {WriteOptions{.draco = true}, WriteOptions{.quantize = true}})
      for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        const Scene scene = strewn(seed);
        const double bound = packing_error_px(scene, write, projection, raster);
        const double seen = displacement(scene, reread(scene, write), projection, raster);
        EXPECT_LE(seen, bound) << "seed " << seed << " draco " << write.draco;
        EXPECT_GE(seen, 0.2 * bound) << "a bound that says nothing: seed " << seed << " draco " << write.draco;
      }
}

TEST(PackingError, IsNoneWhereNothingIsRounded) {
  for (const WriteOptions write : {WriteOptions{}, WriteOptions{.meshopt = true}})
    EXPECT_EQ(packing_error_px(strewn(4), write, Projection::perspective, {64, 64}), 0);
}

TEST(PackingError, IsWithoutBoundWhereAVertexMayReachTheCamera) {
  Scene scene = strewn(5);
  scene.meshes[0].primitives[0].positions[7] = {0, 0, -1e-6f};
  EXPECT_EQ(packing_error_px(scene, {.quantize = true}, Projection::perspective, {64, 64}), std::numeric_limits<double>::infinity());
}

} // namespace
} // namespace domewarp
