// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/read_attributes.h"

#include <gtest/gtest.h>

namespace domewarp {
namespace {

TEST(AttributeReader, FollowsWhatMaterialsName) {
  Scene scene;
  scene.materials.resize(4);
  scene.materials[1].json = R"({"normalTexture":{"index":0,"texCoord":1},"pbrMetallicRoughness":{"baseColorTexture":{"index":1}}})";
  scene.materials[2].unlit = true;
  scene.materials[2].json = R"({"extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorTexture":{"index":1}}})";
  scene.materials[3].json = R"({"extensions":{"KHR_materials_clearcoat":{"clearcoatNormalTexture":{"index":0,"extensions":{"KHR_texture_transform":{"texCoord":2}}}}}})";
  const auto reads = attribute_reader(scene, false), reads_unlit = attribute_reader(scene, true);
  for (const int material : {-1, 0, 1, 2, 3}) {
    EXPECT_TRUE(reads(material, "COLOR_0"));
    EXPECT_TRUE(reads(material, "_BATCH"));
    EXPECT_FALSE(reads(material, "COLOR_1"));
    EXPECT_FALSE(reads(material, "JOINTS_0"));
    EXPECT_EQ(reads(material, "NORMAL"), material != 2);
    EXPECT_FALSE(reads_unlit(material, "NORMAL"));
    EXPECT_FALSE(reads_unlit(material, "TANGENT"));
    EXPECT_EQ(reads(material, "TEXCOORD_0"), material >= 1);
    EXPECT_EQ(reads(material, "TEXCOORD_1"), material == 1 || material == 3); // 3: sets are numbered without a gap
    EXPECT_EQ(reads(material, "TEXCOORD_2"), material == 3);
    EXPECT_EQ(reads(material, "TANGENT"), material == 1 || material == 3);
  }
}

} // namespace
} // namespace domewarp
