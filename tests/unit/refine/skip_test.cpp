// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "domewarp/refine/hidden_faces.h"
#include "domewarp/transform/image_map.h"
#include "shapes.h"

namespace domewarp {
namespace {

const Raster wide{1024, 512};

const Scene& box() {
  static const Scene scene = box_scene({-3.1f, -1.6f, -6.3f}, {2.7f, 1.9f, 2.2f});
  return scene;
}

/// How many triangles show each of many points of the picture.
std::vector<int> shown_layers(const Scene& scene) {
  std::vector<Vec2> points;
  for (int i = 0; i < 61; ++i)
    for (int j = 0; j < 61; ++j) points.emplace_back(aspect(wide) * ((i + 0.4711) / 30.5 - 1), (j + 0.5217) / 30.5 - 1);
  std::vector<int> layers(points.size(), 0);
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        std::array<Vec2, 3> image;
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3f p = primitive.positions[primitive.indices[i + k]];
          image[k] = Vec2(p) / -static_cast<double>(p.z);
        }
        const auto side = [&](std::size_t k, const Vec2& p) {
          const Vec2 u = image[(k + 1) % 3] - image[k], v = p - image[k];
          return u.x * v.y - u.y * v.x > 0;
        };
        for (std::size_t p = 0; p < points.size(); ++p) layers[p] += side(0, points[p]) == side(1, points[p]) && side(1, points[p]) == side(2, points[p]);
      }
    }
  return layers;
}

TEST(Skip, OffPictureLeavesOutNothingThatThePictureShows) {
  for (const SurfaceOptions& surface : {curve("1-r^2"), curve("1-r"), lens(Lens::equidistant, 180), lens(Lens::stereographic, 240)})
    for (const Scene& scene : {box(), triangles_scene({{-0.9f, -2, 0.3f}, {3, -1, -8}, {-4, 5, 1}}), triangles_scene({{-90, -1.5f, 50}, {90, -1.5f, 50}, {0, -1.5f, -90}})}) {
      RefineOptions all;
      all.skip.off_picture = false;
      const Conversion lean = convert_shape(scene, surface, {}, wide), whole = convert_shape(scene, surface, all, wide);
      EXPECT_EQ(shown_layers(lean.scene), shown_layers(whole.scene)) << surface.curve;
      EXPECT_LE(lean.report.triangles_out, whole.report.triangles_out);
      EXPECT_EQ(lean.report.open_edges, whole.report.open_edges);
    }
}

TEST(Skip, OffPictureSavesWork) {
  RefineOptions all;
  all.skip.off_picture = false;
  const Conversion lean = convert_shape(box(), curve("1-r^2"), {}, wide), whole = convert_shape(box(), curve("1-r^2"), all, wide);
  EXPECT_LT(lean.report.map_evaluations, 0.8 * static_cast<double>(whole.report.map_evaluations));
  EXPECT_GT(lean.report.skipped.off_picture, 0u);
  EXPECT_EQ(whole.report.skipped.off_picture, 0u);
}

TEST(Skip, LeavesOutAttributesThatNobodyReads) {
  Scene scene = box();
  Primitive& primitive = scene.meshes[0].primitives[0];
  primitive.attributes = {{"NORMAL", 3, std::vector<float>(3 * primitive.positions.size(), 1)},
                          {"TEXCOORD_0", 2, std::vector<float>(2 * primitive.positions.size(), 0.5f)}};
  RefineOptions options;
  options.reads = [](int, const std::string& attribute) { return attribute == "TEXCOORD_0"; };
  const Conversion lean = convert_shape(scene, curve("1-r^2"), options, wide);
  const Primitive& written = lean.scene.meshes[0].primitives[0];
  EXPECT_EQ(find_attribute(written, "NORMAL"), nullptr);
  ASSERT_NE(find_attribute(written, "TEXCOORD_0"), nullptr);
  for (const float value : find_attribute(written, "TEXCOORD_0")->values) ASSERT_EQ(value, 0.5f);
  EXPECT_EQ(lean.report.skipped.unused_attributes, 1u);
  EXPECT_EQ(lean.report.skipped.attributes, 2u);
  options.skip.unused_attributes = false;
  const Conversion whole = convert_shape(scene, curve("1-r^2"), options, wide);
  EXPECT_NE(find_attribute(whole.scene.meshes[0].primitives[0], "NORMAL"), nullptr);
  EXPECT_EQ(whole.scene.meshes[0].primitives[0].positions, written.positions);
}

TEST(Hidden, TheNearestPointOfATriangleIsOnItsFaceOnASideOrACorner) {
  EXPECT_DOUBLE_EQ(nearest_distance({-1, -1, -2}, {1, -1, -2}, {0, 2, -2}), 2);
  EXPECT_DOUBLE_EQ(nearest_distance({-1, 1, -2}, {1, 1, -2}, {0, 2, -2}), std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(nearest_distance({1, 1, -2}, {2, 1, -2}, {1, 2, -2}), std::sqrt(6.0));
  EXPECT_DOUBLE_EQ(nearest_distance({1, 1, -2}, {1, 1, -2}, {1, 1, -3}), std::sqrt(6.0)); // no area
}

} // namespace
} // namespace domewarp
