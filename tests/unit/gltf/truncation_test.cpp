// SPDX-License-Identifier: Apache-2.0
#include <random>

#include <gtest/gtest.h>

#include "domewarp/gltf/write.h"
#include "gltf_file.h"

namespace domewarp::test {
namespace {

/// Every feature that has bytes of its own: indices, attributes, an image.
std::vector<std::uint8_t> rich_glb() {
  GltfFile file = triangle_file();
  const std::vector<std::uint8_t> png = tiny_png();
  json& primitive = file.root["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = file.add(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2");
  primitive["indices"] = file.add(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR");
  primitive["material"] = 0;
  file.root["images"] = {{{"mimeType", "image/png"}, {"bufferView", file.add_view(png.data(), png.size())}}};
  file.root["textures"] = {{{"source", 0}}};
  file.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  return file.glb();
}

TEST(Truncation, RefusesEveryPrefixOfAGlb) {
  const TemporaryFolder folder;
  for (const std::vector<std::uint8_t>& glb : {rich_glb(), encode_glb(triangle_file().read(), {.draco = true}), encode_glb(triangle_file().read(), {.meshopt = true})}) {
    for (std::size_t size = 0; size < glb.size(); ++size) {
      write_bytes(folder / "cut.glb", {glb.begin(), glb.begin() + static_cast<std::ptrdiff_t>(size)});
      EXPECT_NE(refusal(folder / "cut.glb"), "") << size << " of " << glb.size() << " bytes were read";
    }
    write_bytes(folder / "whole.glb", glb);
    EXPECT_EQ(refusal(folder / "whole.glb"), "");
  }
}

TEST(Truncation, RefusesOrReadsEveryPrefixWithARepairedHeader) {
  // The header's length agrees with the file, so the cut shows only further in.
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> glb = rich_glb();
  for (std::size_t size = 20; size < glb.size(); ++size) {
    std::vector<std::uint8_t> cut(glb.begin(), glb.begin() + static_cast<std::ptrdiff_t>(size));
    for (std::size_t i = 0; i < 4; ++i) cut[8 + i] = static_cast<std::uint8_t>(size >> (8 * i));
    write_bytes(folder / "cut.glb", cut);
    EXPECT_NE(refusal(folder / "cut.glb"), "") << size;
  }
}

TEST(Truncation, SurvivesRandomDamage) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> glb = rich_glb();
  std::mt19937 random(2001);
  std::size_t refused = 0;
  const std::size_t trials = 1500;
  for (std::size_t trial = 0; trial < trials; ++trial) {
    std::vector<std::uint8_t> bad = glb;
    for (std::size_t i = 0; i <= trial % 4; ++i)
      bad[20 + random() % (bad.size() - 20)] = static_cast<std::uint8_t>(random());
    write_bytes(folder / "bad.glb", bad);
    refused += !refusal(folder / "bad.glb", {.max_bytes = std::size_t(1) << 28}).empty();
  }
  EXPECT_GT(refused, trials / 3) << "seed 2001";
  EXPECT_LT(refused, trials);
}

} // namespace
} // namespace domewarp::test
