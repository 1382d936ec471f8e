// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/compare.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "domewarp/audit/exact_rays.h"
#include "domewarp/core/errors.h"
#include "domewarp/render/compare_page.h"
#include "domewarp/render/compare_pictures.h"
#include "domewarp/render/drawn_crossings.h"
#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "render_scenes.h"

namespace domewarp {
namespace {

using namespace test;

/// A scene with its display and its reference, to judge warped files by.
class Judge {
 public:
  Judge(const Scene& scene, const Display& display)
      : display_(display), rays_(scene, View{}),
        crossings_(keep_drawn(scene, [this](const Vec3& direction) { return rays_.crossings(direction); }, 0)),
        reference(ray_trace(scene, View{}, display.surface, display.raster, {})) {}

  CompareReport frames(const Frame& warped, const Screen& screen, const CompareOptions& options = {}) const {
    return compare_frames(reference, warped, screen, display_.surface, display_.map, display_.raster, crossings_,
                          options);
  }
  CompareReport operator()(const Scene& warped, const CompareOptions& options = {}) const {
    return frames(rasterise(warped, display_.raster, {}), make_screen(warped, display_.raster), options);
  }

 private:
  const Display& display_;
  ExactRays rays_;
  CrossingsAlong crossings_;

 public:
  Frame reference;
};

class Compare : public testing::Test {
 protected:
  const Display display = make_display("1-r^2", 160, 120);
  const Scene source = make_room_with_board();
  const Judge judge{source, display};
  const Frame& reference = judge.reference;

  CompareReport compare(const Scene& warped) const { return judge(warped); }
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
    EXPECT_EQ(report.overlaps, 0u);
    EXPECT_LT(report.outline, 20u);
    EXPECT_EQ(report.displacement_px.measured, pixels);
    EXPECT_LT(report.displacement_px.max, 0.05);
    EXPECT_LE(report.displacement_px.p999, report.displacement_px.max);
    EXPECT_LT(report.displacement_px.rms, report.displacement_px.p999);
    EXPECT_EQ(report.depth_rel.measured, pixels);
    EXPECT_LT(report.depth_rel.max, 0.001);
    EXPECT_GT(report.psnr_db.value_or(0), 30);
    EXPECT_LT(report.colour_difference, 1);
    EXPECT_GT(report.ssim.value_or(0), 0.95);
    EXPECT_LT(report.flip.mean, 0.05);
    EXPECT_LE(report.flip.mean, report.flip.max);
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
  const Judge of_board(board, display);
  Scene warped = prewarp(board, display, 8);
  EXPECT_LT(of_board(warped).displacement_px.max, 0.3);
  Vec3f& p = warped.meshes.back().primitives[0].positions[60];
  p.x += static_cast<float>(2 * pixel_size(display.raster)) * std::abs(p.z);
  EXPECT_GT(of_board(warped).displacement_px.max, 1);
}

TEST_F(Compare, AShiftedFileIsMismatchedAtItsOutlines) {
  Scene warped = prewarp(source, display, 64);
  for (Primitive& primitive : warped.meshes[warped.instances.back().mesh].primitives)
    for (Vec3f& p : primitive.positions) p.x += static_cast<float>(3 * pixel_size(display.raster)) * std::abs(p.z);
  const CompareReport report = compare(warped);
  EXPECT_GT(report.displacement_px.max, 2.9);
  EXPECT_GT(report.surface_mismatch, 50u);
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
  ASSERT_EQ(compare(warped).pinholes, 0u);
  remove_triangle_at(warped, frame, 100 * 160 + 30);
  const CompareReport report = compare(warped);
  EXPECT_GT(report.pinholes, 0u);
  EXPECT_GT(report.pinholes, report.pinholes_at_seams) << "most lie inside the wall";
}

TEST_F(Compare, ATriangleThatIsDrawnTwiceIsAnOverlap) {
  Scene warped = prewarp(source, display, 12);
  const Frame frame = rasterise(warped, display.raster, {});
  const std::size_t pixel = 100 * 160 + 30;
  Primitive& primitive = warped.meshes[std::size_t(warped.instances[frame.object[pixel] - 1].mesh)].primitives[0];
  const auto first = static_cast<std::size_t>(3 * (frame.triangle[pixel] - 1));
  for (std::size_t k = 0; k < 3; ++k) primitive.indices.push_back(primitive.indices[first + k]);
  EXPECT_GT(compare(warped).overlaps.value_or(0), 0u);
}

/// It fills what opens between the drawn courses of its sides, as it does in scenes that close T-junctions by such triangles.
TEST_F(Compare, ATriangleWithoutAreaInTheSceneIsNoOverlap) {
  Scene wall;
  add(wall, make_quad({-1.5, -1, -1}, {3, 0, 0}, {0, 2, 0}, -1));
  const Judge of_wall(wall, display);
  CompareOptions options;
  options.depth_bound = 0.1; // the coarse side is drawn pixels from its place
  for (const float rise : {0.0f, 0.02f}) {
    Primitive sliver;
    sliver.positions = {{-0.5f, 0.5f, -1}, {0.5f, 0.5f, -1}, {0, 0.5f + rise, -1}};
    sliver.indices = {0, 1, 2, 0, 2, 1};
    Scene both = wall;
    both.meshes[0].primitives.push_back(sliver);
    Scene warped = prewarp(both, display, 64);
    const Scene coarse = prewarp(both, display, 1);
    const auto mesh_of = [](const Scene& scene) { return std::size_t(scene.instances[0].mesh); };
    warped.meshes[mesh_of(warped)].primitives[1] = coarse.meshes[mesh_of(coarse)].primitives[1];
    const std::size_t overlaps = of_wall(warped, options).overlaps.value_or(9999);
    if (rise == 0)
      EXPECT_EQ(overlaps, 0u);
    else
      EXPECT_GT(overlaps, 10u) << "one with area is";
  }
}

TEST_F(Compare, ACrackBetweenUnequalNeighboursIsAPinhole) {
  // One half of a wall is cut finely, the other is not: its straight edge leaves the fine one's.
  Scene wall;
  add(wall, make_quad({-1.5, -1, -1}, {3, 0, 0}, {0, 1.2, 0}, -1));
  add(wall, make_quad({-1.5, 0.2, -1}, {3, 0, 0}, {0, 1.2, 0}, -1));
  const Judge of_wall(wall, display);
  Scene warped = prewarp(wall, display, 64);
  EXPECT_EQ(of_wall(warped).pinholes, 0u);
  const Scene coarse = prewarp(wall, display, 1);
  const auto mesh_of = [](const Scene& scene) { return std::size_t(scene.instances[0].mesh); };
  warped.meshes[mesh_of(warped)] = coarse.meshes[mesh_of(coarse)];
  const CompareReport report = of_wall(warped);
  EXPECT_GT(report.pinholes + report.surface_mismatch, 100u) << to_json(report);
  EXPECT_EQ(report.pinholes_at_seams, 0u) << "the two share vertices";
  EXPECT_GE(report.flaws.size(), 32u);
}

/// The same wall in pieces that share no vertex: nothing holds them together, and the report says so.
TEST_F(Compare, AGapBetweenAbuttingPiecesIsASeam) {
  Scene wall;
  add(wall, make_quad({-1.5, -1, -1}, {3, 0, 0}, {0, 1.2, 0}, -1));
  add(wall, make_quad({-1.51, 0.2, -1}, {3.02, 0, 0}, {0, 1.2, 0}, -1));
  const Judge of_wall(wall, display);
  Scene warped = prewarp(wall, display, 64);
  EXPECT_EQ(of_wall(warped).pinholes, 0u);
  for (Vec3f& p : warped.meshes[std::size_t(warped.instances[1].mesh)].primitives[0].positions)
    p.y += static_cast<float>(0.4 * pixel_size(display.raster)) * std::abs(p.z); // no farther than the tolerance
  const CompareReport report = of_wall(warped);
  EXPECT_GT(report.pinholes, 20u);
  EXPECT_EQ(report.pinholes, report.pinholes_at_seams);
}

TEST_F(Compare, SurfacesNearerThanTheDepthBoundAreTies) {
  // The farther of two walls that are 0.1 % apart is drawn in front.
  Scene walls;
  add(walls, make_quad({-0.5, -0.5, -1}, {1, 0, 0}, {0, 1, 0}, -1));
  add(walls, make_quad({-0.5, -0.5, -1.001}, {1, 0, 0}, {0, 1, 0}, -1));
  const Judge of_walls(walls, display);
  Scene warped = prewarp(walls, display, 32);
  EXPECT_EQ(of_walls(warped).depth_ties, 0u);
  warped.instances.erase(warped.instances.begin());
  const CompareReport ties = of_walls(warped);
  EXPECT_GT(ties.depth_ties, 1000u);
  EXPECT_EQ(ties.surface_mismatch, 0u);
  const CompareReport strict = of_walls(warped, {.depth_bound = 0.0005});
  EXPECT_EQ(strict.depth_ties, 0u);
  EXPECT_GT(strict.surface_mismatch, 1000u);
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
  EXPECT_EQ(report.depth_rel.measured, 160u * 120);
}

/// Half a pixel along a slanted wall changes the distance by far more than any depth is off.
TEST_F(Compare, DisplacementAlongASlantedWallIsNoDepthError) {
  Scene wall;
  add(wall, make_quad({-0.2, -0.2, -1}, {0.4, 0, 0}, {0, -0.1, -6}, -1));
  const Judge of_wall(wall, display);
  Scene warped = prewarp(wall, display, 256);
  const double still = of_wall(warped).depth_rel.max;
  EXPECT_LT(still, 1e-3);
  const auto change = [&](auto&& move) {
    for (Mesh& mesh : warped.meshes)
      for (Primitive& primitive : mesh.primitives)
        for (Vec3f& p : primitive.positions) move(p);
  };
  change([&](Vec3f& p) { p.y += static_cast<float>(0.4 * pixel_size(display.raster)) * std::abs(p.z); });
  const CompareReport moved = of_wall(warped);
  EXPECT_NEAR(moved.displacement_px.max, 0.4, 0.05);
  EXPECT_LT(moved.depth_rel.max, 1e-3);
  const Frame frame = rasterise(warped, display.raster, {});
  double distance_off = 0;
  for (std::size_t i = 0; i < frame.depth.size(); ++i)
    if (frame.object[i] && of_wall.reference.object[i])
      distance_off = std::max(distance_off, std::abs(double(frame.depth[i]) / of_wall.reference.depth[i] - 1));
  EXPECT_GT(distance_off, 0.02) << "or this test shows nothing";
  change([](Vec3f& p) { p *= 1.01f; }); // drawn at the same place, but as if farther off
  EXPECT_NEAR(of_wall(warped).depth_rel.max, 0.01, 1e-3);
}

TEST_F(Compare, AFalseDepthIsFound) {
  Scene warped = prewarp(source, display, 64);
  for (Attribute& attribute : warped.meshes[warped.instances[0].mesh].primitives[0].attributes)
    if (attribute.name == "_SOURCE_POSITION")
      for (float& value : attribute.values) value *= 1.005f;
  const CompareReport report = compare(warped);
  EXPECT_LT(report.displacement_px.max, 0.05) << "the direction is right";
  EXPECT_NEAR(report.depth_rel.max, 0.005, 0.0005);
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
  for (const char* key : {"coverage", "pinholes", "surface_mismatch", "displacement_px", "depth_rel", "psnr_db",
                          "overlaps", "ssim", "flip"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["coverage"]["both"], report.coverage.both);
  EXPECT_EQ(json["displacement_px"]["max"], report.displacement_px.max);
}

TEST_F(Compare, EqualFramesHaveNoDifference) {
  const CompareReport report = judge.frames(reference, Screen{});
  EXPECT_FALSE(report.psnr_db.has_value());
  EXPECT_EQ(report.colour_difference, 0);
  EXPECT_NEAR(report.ssim.value_or(0), 1, 1e-12);
  EXPECT_EQ(report.flip.max, 0);
  EXPECT_EQ(report.outline, 0u);
  EXPECT_EQ(report.depth_rel.max, 0);
  EXPECT_LT(report.displacement_px.max, 1e-3) << "rays go through pixel centres";
}

TEST_F(Compare, SizesMustAgree) {
  EXPECT_THROW(judge.frames(make_frame(160, 121), Screen{}), Error);
}

TEST_F(Compare, PicturesShowWhatWasFound) {
  Scene warped = prewarp(source, display, 12);
  remove_triangle_at(warped, rasterise(warped, display.raster, {}), 100 * 160 + 30);
  const Frame frame = rasterise(warped, display.raster, {});
  const CompareReport report = compare(warped);
  const Pixels heat = displacement_picture(report, 160, 120, 0.5);
  EXPECT_GT(heat.height, display.raster.height);
  ASSERT_GT(report.pinholes, 0u);
  const Pixels difference = difference_picture(reference, frame), cracks = crack_picture(report, frame);
  for (std::size_t i = 0; i < report.verdicts.size(); ++i)
    for (const Pixels* pixels : {&heat, &difference, &cracks})
      if (report.verdicts[i] == Verdict::pinhole) {
        EXPECT_EQ(std::vector<std::uint8_t>(&pixels->rgba[4 * i], &pixels->rgba[4 * i + 3]),
                  (std::vector<std::uint8_t>{255, 0, 255}));
      }
}

TEST_F(Compare, TheWireframeLiesOnTheTrianglesOfThePicture) {
  const Scene warped = prewarp(source, display, 4);
  const Frame frame = rasterise(warped, display.raster, {});
  const Pixels picture = wireframe_picture(frame, make_screen(warped, display.raster));
  const auto id = [&](std::size_t i) { return std::pair(frame.object[i], frame.triangle[i]); };
  std::size_t lines = 0, inside = 0;
  for (std::size_t row = 2; row + 2 < std::size_t(frame.height); ++row)
    for (std::size_t column = 2; column + 2 < std::size_t(frame.width); ++column) {
      const std::size_t i = row * std::size_t(frame.width) + column;
      bool near_edge = false;
      for (const int dy : {-2, -1, 0, 1, 2})
        for (const int dx : {-2, -1, 0, 1, 2}) near_edge |= id(i) != id(i + std::size_t(dy) * std::size_t(frame.width) + std::size_t(dx));
      const bool is_kept = std::equal(&frame.rgba[4 * i], &frame.rgba[4 * i + 4], &picture.rgba[4 * i]);
      for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) EXPECT_GE(picture.rgba[k], frame.rgba[k]);
      lines += !is_kept;
      inside += is_kept;
      EXPECT_TRUE(is_kept || near_edge) << column << ", " << row;
    }
  EXPECT_GT(lines, 500u);
  EXPECT_GT(inside, lines);
}

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST_F(Compare, PageNeedsNothingElse) {
  const Scene warped = prewarp(source, display, 64);
  const Frame frame = rasterise(warped, display.raster, {});
  const Screen screen = make_screen(warped, display.raster);
  const CompareReport report = judge.frames(frame, screen);
  ComparePage page;
  page.scene = "<a \"x\">&";
  page.warped = "warped.glb";
  page.renderer = frame.renderer;
  page.reference = colours(reference);
  page.rasterised = colours(frame);
  page.difference = difference_picture(reference, frame);
  page.displacement = displacement_picture(report, frame.width, frame.height, 1);
  page.cracks = crack_picture(report, frame);
  page.wireframe = wireframe_picture(frame, screen);
  const std::string html = compare_page(page, report, display.surface);
  EXPECT_EQ(count_of(html, "src="), 6u);
  EXPECT_EQ(count_of(html, "src=\"data:image/png;base64,iVBOR"), 6u);
  for (const char* word : {"http:", "https:", "href=", "url(", "@import", "<link", "<iframe", "fetch", "<a "})
    EXPECT_EQ(count_of(html, word), 0u) << word;
  EXPECT_EQ(count_of(html, "&lt;a &quot;x&quot;&gt;&amp;"), 2u); // title and heading
  EXPECT_GE(count_of(html, "<svg"), 1u);
  EXPECT_EQ(count_of(html, "class=\"figure bad\""), 0u);
  EXPECT_GE(count_of(html, "class=\"figure good\""), 4u);

  CompareReport bad = report;
  bad.displacement_px.max = 0.51;
  bad.pinholes = 1;
  EXPECT_EQ(count_of(compare_page(page, bad, display.surface), "class=\"figure bad\""), 2u);
}

} // namespace
} // namespace domewarp
