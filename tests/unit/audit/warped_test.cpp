// SPDX-License-Identifier: GPL-3.0-or-later
// The audit of warped files: a sound file passes, and every kind of damage done to it on purpose is seen.
#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "domewarp/audit/inspect.h"
#include "domewarp/refine/refine.h"

namespace domewarp {
namespace {

const Raster raster{1024, 1024};

/// A floor of two triangles and a wall that shares an edge with it, and a closed box around the eye.
Scene room() {
  const auto corner = [](int i) { return Vec3f(i & 1 ? 2.7f : -3.1f, i & 2 ? 1.9f : -1.6f, i & 4 ? 2.2f : -6.3f); };
  Primitive primitive;
  for (const auto& quad : {std::array{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}})
    for (const int i : {0, 1, 2, 0, 2, 3}) {
      primitive.indices.push_back(static_cast<std::uint32_t>(primitive.positions.size()));
      primitive.positions.push_back(corner(quad[static_cast<std::size_t>(i)]));
    }
  primitive.material = 0;
  Scene scene;
  scene.meshes.push_back({"room", {primitive}});
  scene.instances.push_back({"room", 0, Mat4(1)});
  scene.materials.emplace_back();
  scene.materials[0].double_sided = true;
  return scene;
}

/// A conversion of the room and what the audit is told of it.
struct Warped {
  explicit Warped(const RefineOptions& options = {}, const std::string& curve = "1-r^2") : source(room()), picture(make(curve)) {
    RefineOptions with_source = options;
    with_source.source_attributes = true;
    RefineReport report;
    scene = refine(source, picture.view, picture.surface, picture.map, raster, with_source, report);
    picture.near = report.near;
    picture.perspective = options.projection == Projection::perspective;
  }

  InspectReport audit() const { return inspect(scene, {&picture, &source, 20'000}); }
  Primitive& primitive() { return scene.meshes[0].primitives[0]; }

  static Picture make(const std::string& curve) {
    SurfaceOptions options;
    options.curve = curve;
    Surface surface(options, screen_radius(raster));
    ImageMap map = make_image_map(surface, Method::direct);
    return {std::move(surface), std::move(map), View{}, raster, true, 0};
  }

  Scene source, scene;
  Picture picture;
};

/// The triangle near the middle of the picture that covers most of it: samples find it.
std::size_t middle_triangle(const Primitive& primitive) {
  std::size_t best = 0;
  float largest = 0;
  for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
    const auto at = [&](std::size_t k) {
      const Vec3f p = primitive.positions[primitive.indices[i + k]];
      return Vec2f(p.x, p.y) / -p.z;
    };
    const Vec2f u = at(1) - at(0), v = at(2) - at(0);
    const float area = std::abs(u.x * v.y - u.y * v.x);
    if (std::abs(at(0).x) > 0.5f || std::abs(at(0).y) > 0.5f || area <= largest) continue;
    largest = area;
    best = i;
  }
  EXPECT_GT(largest, 0);
  return best;
}

TEST(WarpedAudit, PassesASoundFileInBothProjections) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const char* curve : {"1-r^2", "1-r"}) {
      RefineOptions options;
      options.projection = projection;
      const InspectReport report = Warped(options, curve).audit();
      EXPECT_TRUE(is_sound(report)) << to_text(report);
      EXPECT_GT(report.coverage->samples, 5'000u);
      EXPECT_LE(report.coverage->error_px_max, 0.5);
      EXPECT_GT(report.coverage->error_px_max, 0.1); // it measures something
    }
}

TEST(WarpedAudit, PassesASoundFileOfSeveralBranches) {
  RefineOptions options;
  options.tolerance_px = 8;
  const InspectReport report = Warped(options, "-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1").audit();
  EXPECT_TRUE(is_sound(report)) << to_text(report);
}

TEST(WarpedAudit, SeesTheCracksOfTheThesisScheme) {
  RefineOptions options;
  options.subdivision = Subdivision::isotropic;
  options.isotropic = {0.1, 9};
  const InspectReport report = Warped(options).audit();
  EXPECT_FALSE(is_sound(report));
  EXPECT_GT(report.cracks->t_junctions, 100u);
  EXPECT_GT(report.cracks->open_edges, 100u);
  EXPECT_GT(report.cracks->max_gap_px, 0.4);
  EXPECT_GT(report.cracks->gap_area_px2, 100);
  EXPECT_EQ(report.cracks->torn_positions, 0u); // its vertices are where they belong, only too few
}

TEST(WarpedAudit, SeesATornVertex) {
  Warped warped;
  Primitive& primitive = warped.primitive();
  const std::size_t i = middle_triangle(primitive);
  const std::uint32_t old = primitive.indices[i];
  primitive.indices[i] = static_cast<std::uint32_t>(primitive.positions.size());
  primitive.positions.push_back(primitive.positions[old] + Vec3f(0.002f, 0, 0));
  std::vector<float>& source = primitive.attributes.back().values;
  for (std::size_t c = 0; c < 3; ++c) source.push_back(source[3 * old + c]);
  const InspectReport report = warped.audit();
  EXPECT_FALSE(is_sound(report));
  EXPECT_EQ(report.cracks->torn_positions, 1u);
  EXPECT_GT(report.cracks->open_edges, 0u);
}

TEST(WarpedAudit, SeesAFlippedTriangle) {
  Warped warped;
  Primitive& primitive = warped.primitive();
  const std::size_t i = middle_triangle(primitive);
  // Mirrored in the picture: the first corner is drawn beyond the opposite edge.
  const Vec3f a = primitive.positions[primitive.indices[i]], b = primitive.positions[primitive.indices[i + 1]], c = primitive.positions[primitive.indices[i + 2]];
  primitive.positions[primitive.indices[i]] = b + c - a;
  const InspectReport report = warped.audit();
  EXPECT_FALSE(is_sound(report));
  EXPECT_GT(report.cracks->flips, 0u);
}

TEST(WarpedAudit, SeesAMissingTriangle) {
  Warped warped;
  std::vector<std::uint32_t>& indices = warped.primitive().indices;
  const auto at = indices.begin() + static_cast<std::ptrdiff_t>(middle_triangle(warped.primitive()));
  indices.erase(at, at + 3);
  const InspectReport report = warped.audit();
  EXPECT_FALSE(is_sound(report));
  EXPECT_EQ(report.cracks->open_edges, 3u);
  EXPECT_GT(report.coverage->lost, 0u);
  EXPECT_GT(report.coverage->lost_area_px2, 10);
}

TEST(WarpedAudit, SeesATriangleDrawnTwice) {
  Warped warped;
  std::vector<std::uint32_t>& indices = warped.primitive().indices;
  const std::size_t i = middle_triangle(warped.primitive());
  for (std::size_t k = 0; k < 3; ++k) indices.push_back(indices[i + k]);
  const InspectReport report = warped.audit();
  EXPECT_FALSE(is_sound(report));
  EXPECT_GT(report.coverage->overlapping, 0u);
  EXPECT_EQ(report.duplicate, 1u);
}

TEST(WarpedAudit, MeasuresAShiftedPicture) {
  Warped warped;
  for (Vec3f& p : warped.primitive().positions) p.x += -p.z * 4 * static_cast<float>(pixel_size(raster));
  EXPECT_NEAR(warped.audit().coverage->error_px_max, 4, 0.5);
}

TEST(WarpedAudit, TheHausdorffDistanceIsWithinTheToleranceAndSeesAHole) {
  RefineOptions options;
  options.tolerance_px = 16;
  options.depth_tolerance = 0.016; // 4 px in the third coordinate
  Warped warped(options);
  InspectOptions ask{&warped.picture, &warped.source, 100};
  ask.hausdorff_px = 16;
  const HausdorffReport sound = *inspect(warped.scene, ask).hausdorff;
  EXPECT_GT(sound.exact_triangles, 1000u);
  EXPECT_LE(sound.distance_px, std::hypot(16, 4) + sound.error_px);
  std::vector<std::uint32_t>& indices = warped.primitive().indices;
  const auto at = indices.begin() + static_cast<std::ptrdiff_t>(middle_triangle(warped.primitive()));
  indices.erase(at, std::min(at + 180, indices.end())); // 60 neighbours
  EXPECT_GT(inspect(warped.scene, ask).hausdorff->distance_px, 2 * sound.distance_px);
}

TEST(WarpedAudit, WithoutSourceAttributesItMapsBack) {
  Warped warped;
  warped.primitive().attributes.pop_back();
  const InspectReport report = warped.audit();
  EXPECT_FALSE(report.cracks->exact_provenance);
  EXPECT_TRUE(is_sound(report)) << to_text(report);
  std::vector<std::uint32_t>& indices = warped.primitive().indices;
  indices.resize(indices.size() - 3 * 50);
  EXPECT_FALSE(is_sound(warped.audit()));
}

} // namespace
} // namespace domewarp
