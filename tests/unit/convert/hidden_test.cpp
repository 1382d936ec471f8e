// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/hidden.h"

#include <gtest/gtest.h>

#include "domewarp/convert/convert.h"

namespace domewarp {
namespace {

/// A wall at z = -2 from -1 to 1, and a row of 40 small triangles from x = -4 to 4 behind it, at z = -4: the wall hides
/// those within x = -2 .. 2.
Scene wall_before_a_row() {
  Primitive wall, row;
  wall.material = 0;
  row.material = 1;
  wall.positions = {{-1, -1, -2}, {1, -1, -2}, {1, 1, -2}, {-1, 1, -2}};
  wall.indices = {0, 1, 2, 0, 2, 3};
  for (int i = 0; i < 40; ++i) {
    const float x = -3.95F + 0.2F * static_cast<float>(i);
    for (const Vec3f& corner : {Vec3f(x - 0.05F, 0, -4), Vec3f(x + 0.05F, 0, -4), Vec3f(x, 0.1F, -4)}) {
      row.indices.push_back(static_cast<std::uint32_t>(row.positions.size()));
      row.positions.push_back(corner);
    }
  }
  Scene scene;
  scene.meshes.push_back({"all", {wall, row}});
  scene.instances.push_back({"all", 0, Mat4(1)});
  scene.materials.resize(2);
  return scene;
}

ConvertReport convert_with(const Scene& scene, bool cull_hidden, std::size_t& row_triangles) {
  ConvertOptions options;
  options.surface.lens = Lens::equidistant;
  options.raster = {256, 256};
  options.view.eye = Vec3(0);
  options.view.forward = Vec3(0, 0, -1);
  options.cull_hidden = cull_hidden;
  ConvertReport report;
  const Scene warped = convert(scene, options, report);
  row_triangles = 0;
  for (const Primitive& primitive : warped.meshes[0].primitives)
    if (primitive.material == 1) row_triangles += primitive.indices.size() / 3;
  return report;
}

TEST(CullHidden, LeavesOutWhatAWallHidesAndNothingElse) {
  std::size_t kept = 0, all = 0;
  const ConvertReport culled = convert_with(wall_before_a_row(), true, kept);
  EXPECT_EQ(convert_with(wall_before_a_row(), false, all).refine.skipped.hidden, 0u);
  EXPECT_EQ(all, 40u);
  EXPECT_EQ(culled.refine.skipped.hidden + kept, 40u);
  // 20 are behind the wall; the outermost two, within a pixel and the tolerance of its edge, must be kept.
  EXPECT_GE(culled.refine.skipped.hidden, 16u);
  EXPECT_LE(culled.refine.skipped.hidden, 20u);
}

TEST(CullHidden, BlendedSurfacesAndBackFacesHideNothing) {
  std::size_t kept = 0;
  Scene scene = wall_before_a_row();
  scene.materials[0].alpha_mode = AlphaMode::blend;
  convert_with(scene, true, kept);
  EXPECT_EQ(kept, 40u);
  scene = wall_before_a_row();
  std::swap(scene.meshes[0].primitives[0].indices[0], scene.meshes[0].primitives[0].indices[1]);
  std::swap(scene.meshes[0].primitives[0].indices[3], scene.meshes[0].primitives[0].indices[4]);
  convert_with(scene, true, kept);
  EXPECT_EQ(kept, 40u);
}

TEST(SeenDepths, AskForEveryRayWithinTheMargin) {
  Scene scene = wall_before_a_row();
  scene.meshes[0].primitives.pop_back();
  SurfaceOptions lens;
  lens.lens = Lens::equidistant;
  const Raster raster{256, 256};
  const SeenDepths seen(scene, View{}, Surface(lens, screen_radius(raster)), raster);
  const double edge = std::atan(0.5) / (0.5 * 3.14159265358979); // image of the wall's right edge at y = 0
  EXPECT_TRUE(seen.is_hidden({-0.1, -0.1}, {0.1, 0.1}, 0, 3));
  EXPECT_FALSE(seen.is_hidden({-0.1, -0.1}, {0.1, 0.1}, 0, 2));   // as near as the wall
  EXPECT_TRUE(seen.is_hidden({edge - 0.03, 0}, {edge - 0.02, 0.01}, 0.015, 3));
  EXPECT_FALSE(seen.is_hidden({edge - 0.03, 0}, {edge - 0.02, 0.01}, 0.03, 3)); // a ray within the margin passes the wall
  EXPECT_FALSE(seen.is_hidden({0.9, 0.9}, {0.95, 0.95}, 0, 3));   // nothing there
  EXPECT_FALSE(seen.is_hidden({1.5, 0}, {1.6, 0.1}, 0, 3));       // outside the picture
}

} // namespace
} // namespace domewarp
