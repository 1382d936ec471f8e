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

using Corners = std::array<std::array<float, 3>, 3>;

/// The source corners of every triangle of which the picture, widened by the margin, may show something.
std::vector<Corners> shown_triangles(const Scene& scene, double margin) {
  std::vector<Corners> shown;
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
      for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        Corners corners;
        std::array<Vec2, 3> image;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t v = primitive.indices[i + k];
          for (std::size_t c = 0; c < 3; ++c) corners[k][c] = source[3 * v + c];
          image[k] = Vec2(primitive.positions[v]) / -static_cast<double>(primitive.positions[v].z);
        }
        bool is_shown = true;
        for (int axis = 0; axis < 2; ++axis) {
          const double extent = (axis == 0 ? aspect(wide) : 1) + margin;
          const auto [low, high] = std::minmax({image[0][axis], image[1][axis], image[2][axis]});
          is_shown = is_shown && low <= extent && high >= -extent;
        }
        if (is_shown) shown.push_back(corners);
      }
    }
  std::sort(shown.begin(), shown.end());
  return shown;
}

TEST(Skip, OffPictureLeavesOutNothingThatThePictureShows) {
  for (const SurfaceOptions& surface : {curve("1-r^2"), curve("1-r"), lens(Lens::equidistant, 180), lens(Lens::stereographic, 240)})
    for (const Scene& scene : {box(), triangles_scene({{-0.9f, -2, 0.3f}, {3, -1, -8}, {-4, 5, 1}}), triangles_scene({{-90, -1.5f, 50}, {90, -1.5f, 50}, {0, -1.5f, -90}})}) {
      RefineOptions all;
      all.skip.off_picture = false;
      const Conversion lean = convert_shape(scene, surface, {}, wide), whole = convert_shape(scene, surface, all, wide);
      const double margin = 1.5 * pixel_size(wide);
      EXPECT_EQ(shown_triangles(lean.scene, margin), shown_triangles(whole.scene, margin)) << surface.curve;
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
