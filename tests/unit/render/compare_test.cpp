// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/compare.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "render_scenes.h"

namespace domewarp {
namespace {

using namespace test;

class Compare : public testing::Test {
 protected:
  const Display display = make_display("1-r^2", 160, 120);
  const Scene source = make_room_with_board();
  const Frame reference = ray_trace(source, View{}, display.surface, display.raster, {});

  CompareReport compare(const Scene& warped) const {
    return compare_frames(reference, rasterise(warped, display.raster, {}), display.surface, display.map,
                          display.raster);
  }
};

TEST_F(Compare, AGoodFilePasses) {
  for (const Output output : {Output::perspective, Output::orthographic}) {
    const CompareReport report = compare(prewarp(source, display, 64, output));
    const std::size_t pixels = 160 * 120;
    EXPECT_EQ(report.coverage.reference, pixels);
    EXPECT_EQ(report.coverage.warped, pixels);
    EXPECT_EQ(report.coverage.both, pixels);
    EXPECT_EQ(report.pinholes, 0u);
    EXPECT_EQ(report.surface_mismatch, 0u);
    EXPECT_EQ(report.displacement_px.measured, pixels);
    EXPECT_LT(report.displacement_px.max, 0.05);
    EXPECT_LE(report.displacement_px.p999, report.displacement_px.max);
    EXPECT_LT(report.displacement_px.rms, report.displacement_px.p999);
    EXPECT_GT(report.depth_rel.measured, pixels / 2);
    EXPECT_LT(report.depth_rel.max, 0.002);
    EXPECT_GT(report.psnr_db.value_or(0), 30);
    EXPECT_LT(report.colour_difference, 1);
  }
}

TEST_F(Compare, ACoarseFileIsDisplaced) {
  const CompareReport report = compare(prewarp(source, display, 4));
  EXPECT_GT(report.displacement_px.max, 2);
  EXPECT_GT(report.displacement_px.rms, 0.2);
}

TEST_F(Compare, AShiftedVertexIsFound) {
  Scene board;
  add(board, make_quad({-0.4, -0.5, -1.2}, {0.9, 0.1, 0.1}, {0, 0.8, 0}, -1));
  const Frame rays = ray_trace(board, View{}, display.surface, display.raster, {});
  Scene warped = prewarp(board, display, 8);
  const auto displacement = [&] {
    return compare_frames(rays, rasterise(warped, display.raster, {}), display.surface, display.map, display.raster)
        .displacement_px.max;
  };
  EXPECT_LT(displacement(), 0.3);
  Vec3f& p = warped.meshes.back().primitives[0].positions[60];
  p.x += static_cast<float>(2 * pixel_size(display.raster)) * std::abs(p.z);
  EXPECT_GT(displacement(), 1);
}

/// Takes away the triangle that is seen in a pixel.
void remove_triangle_at(Scene& warped, const Frame& frame, std::size_t pixel) {
  const Instance& instance = warped.instances[frame.object[pixel] - 1];
  Primitive& primitive = warped.meshes[std::size_t(instance.mesh)].primitives[0];
  const auto first = primitive.indices.begin() + 3 * static_cast<std::ptrdiff_t>(frame.triangle[pixel] - 1);
  primitive.indices.erase(first, first + 3);
}

TEST_F(Compare, ARemovedTriangleIsAPinhole) {
  Scene warped = prewarp(source, display, 12);
  const Frame frame = rasterise(warped, display.raster, {});
  const CompareReport whole = compare_frames(reference, frame, display.surface, display.map, display.raster);
  ASSERT_EQ(whole.pinholes, 0u);
  remove_triangle_at(warped, frame, 100 * 160 + 30);
  EXPECT_GT(compare(warped).pinholes, 0u);
}

TEST_F(Compare, AMissingObjectIsASurfaceMismatch) {
  Scene warped = prewarp(source, display, 64);
  warped.meshes[warped.instances.back().mesh].primitives.clear();
  const CompareReport report = compare(warped);
  EXPECT_EQ(report.coverage.warped, report.coverage.reference);
  EXPECT_GT(report.surface_mismatch, 100u);
}

TEST_F(Compare, OtherNumbersForTheSameObjectsDoNotMatter) {
  Scene warped = prewarp(source, display, 64);
  std::reverse(warped.instances.begin(), warped.instances.end());
  const CompareReport report = compare(warped);
  EXPECT_EQ(report.surface_mismatch, 0u);
  EXPECT_GT(report.depth_rel.measured, 160u * 120 / 2);
}

TEST_F(Compare, AFalseDepthIsFound) {
  Scene warped = prewarp(source, display, 64);
  for (Attribute& attribute : warped.meshes[warped.instances[0].mesh].primitives[0].attributes)
    if (attribute.name == "_SOURCE_POSITION")
      for (float& value : attribute.values) value *= 1.005f;
  const CompareReport report = compare(warped);
  EXPECT_LT(report.displacement_px.max, 0.05) << "the direction is right";
  EXPECT_NEAR(report.depth_rel.max, 0.005, 0.002);
  for (Attribute& attribute : warped.meshes[warped.instances[0].mesh].primitives[0].attributes)
    if (attribute.name == "_SOURCE_POSITION")
      for (float& value : attribute.values) value *= 1.3f;
  EXPECT_GT(compare(warped).surface_mismatch, 100u);
}

TEST_F(Compare, AFileWithoutSourcePositionsIsStillCompared) {
  Scene warped = prewarp(source, display, 64);
  for (Mesh& mesh : warped.meshes)
    for (Primitive& primitive : mesh.primitives)
      std::erase_if(primitive.attributes, [](const Attribute& a) { return a.name == "_SOURCE_POSITION"; });
  const CompareReport report = compare(warped);
  EXPECT_EQ(report.displacement_px.measured, 0u);
  EXPECT_EQ(report.coverage.both, report.coverage.reference);
  EXPECT_EQ(report.surface_mismatch, 0u);
  EXPECT_TRUE(nlohmann::json::parse(to_json(report))["displacement_px"].is_null());
}

TEST_F(Compare, JsonHasThePromisedKeys) {
  const CompareReport report = compare(prewarp(source, display, 24));
  const nlohmann::json json = nlohmann::json::parse(to_json(report));
  for (const char* key : {"coverage", "pinholes", "surface_mismatch", "displacement_px", "depth_rel", "psnr_db"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["coverage"]["both"], report.coverage.both);
  EXPECT_EQ(json["displacement_px"]["max"], report.displacement_px.max);
}

TEST_F(Compare, EqualFramesHaveNoDifference) {
  const CompareReport report = compare_frames(reference, reference, display.surface, display.map, display.raster);
  EXPECT_FALSE(report.psnr_db.has_value());
  EXPECT_EQ(report.colour_difference, 0);
  EXPECT_EQ(report.depth_rel.max, 0);
  EXPECT_LT(report.displacement_px.max, 1e-3) << "rays go through pixel centres";
}

TEST_F(Compare, SizesMustAgree) {
  EXPECT_THROW(compare_frames(reference, make_frame(160, 121), display.surface, display.map, display.raster), Error);
}

TEST_F(Compare, PicturesShowWhatWasFound) {
  Scene warped = prewarp(source, display, 12);
  remove_triangle_at(warped, rasterise(warped, display.raster, {}), 100 * 160 + 30);
  const Frame frame = rasterise(warped, display.raster, {});
  const CompareReport report = compare_frames(reference, frame, display.surface, display.map, display.raster);
  const Pixels heat = displacement_picture(report, display.raster, 0.5);
  EXPECT_GT(heat.height, display.raster.height);
  const Pixels difference = difference_picture(reference, frame);
  ASSERT_GT(report.pinholes, 0u);
  for (std::size_t i = 0; i < report.verdicts.size(); ++i)
    if (report.verdicts[i] == Verdict::pinhole)
      for (const Pixels& pixels : {heat, difference}) {
        EXPECT_EQ(pixels.rgba[4 * i], 255);
        EXPECT_EQ(pixels.rgba[4 * i + 1], 0);
        EXPECT_EQ(pixels.rgba[4 * i + 2], 255);
      }
}

} // namespace
} // namespace domewarp
