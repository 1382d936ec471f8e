// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/refine/edge_oracle.h"
#include "shapes.h"

namespace domewarp {
namespace {

const Raster raster{1024, 1024};

double depth_of(const EdgeOracle& oracle, const Vec3& eye, Projection projection) {
  return projection == Projection::perspective ? oracle.locate(eye).mapped.weight : glm::length(eye);
}

/// Where the ray of an image point meets a plane; not behind the eye.
std::optional<Vec3> on_plane(const Surface& surface, const Vec2& image, const Vec3& point, const Vec3& normal) {
  Vec3 ray;
  if (!unproject(surface, image, ray)) return std::nullopt;
  const double t = glm::dot(normal, point) / glm::dot(normal, ray);
  if (!(t > 0) || !std::isfinite(t)) return std::nullopt;
  return ray * t;
}

/// Largest relative difference between the depth drawn at a pixel and that of the source's plane behind this pixel.
double depth_error(const Conversion& conversion, const SurfaceOptions& options, Projection projection) {
  const Surface surface(options, screen_radius(raster));
  const ImageMap map = make_image_map(surface, Method::direct);
  const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), {1, 1, 1, projection});
  double worst = 0;
  const Primitive& primitive = conversion.scene.meshes.at(0).primitives.at(0);
  const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
  for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
    std::array<Vec3, 3> drawn, eye;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = primitive.indices[i + k];
      drawn[k] = Vec3(primitive.positions[v]);
      eye[k] = Vec3(source[3 * v], source[3 * v + 1], source[3 * v + 2]);
    }
    const Vec3 normal = glm::cross(eye[1] - eye[0], eye[2] - eye[0]);
    if (glm::length(normal) < 1e-4) continue; // float32 corners do not tell its plane
    for (const Vec3& l : {Vec3(1 / 3.0), Vec3(0.5, 0.5, 0), Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5), Vec3(0.5, 0.25, 0.25), Vec3(0.25, 0.5, 0.25)}) {
      const Vec3 p = drawn[0] * l.x + drawn[1] * l.y + drawn[2] * l.z;
      const Vec2 image = projection == Projection::perspective ? Vec2(p) / -p.z : Vec2(p);
      if (const auto q = on_plane(surface, image, eye[0], normal); q && oracle.locate(*q).sides[0] > 0)
        worst = std::max(worst, std::abs(-p.z / depth_of(oracle, *q, projection) - 1));
    }
  }
  return worst;
}

Scene with_texcoords(Scene scene) {
  Primitive& primitive = scene.meshes[0].primitives[0];
  Attribute texcoords{"TEXCOORD_0", 2, {}};
  for (const Vec3f& p : primitive.positions) texcoords.values.insert(texcoords.values.end(), {p.x + 2 * p.y, p.z - p.y});
  primitive.attributes.push_back(texcoords);
  return scene;
}

const Scene box = box_scene(Vec3f(-3.1F, -1.6F, -6.3F), Vec3f(2.7F, 1.9F, 2.2F));

TEST(Inner, PlainWallsStayCoarseButForOutlineAndDepth) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const SurfaceOptions& surface : {curve("1-r^2"), curve("1-r"), lens(Lens::equidistant, 180)}) {
      RefineOptions options;
      options.projection = projection;
      options.tolerance_px = 0.25;
      options.depth_tolerance = 0.01;
      options.skip.off_picture = false; // the room that slides need beside the picture is not to count
      const Conversion fine = convert_shape(box, surface, options, raster);
      options.plain_tolerance_px = 100;
      const Conversion coarse = convert_shape(box, surface, options, raster);
      EXPECT_EQ(coarse.report.plain_faces, 12u);
      EXPECT_LT(coarse.report.triangles_out, fine.report.triangles_out * 3 / 4);
      EXPECT_GT(coarse.report.slide_px_max, 1);
      EXPECT_LE(coarse.report.slide_px_max, 100);
      EXPECT_LE(coarse.report.error_px_max, 0.25);
      EXPECT_EQ(coarse.report.uncertified_edges, 0u);
      EXPECT_LE(coarse.report.uncertified_faces, 8u);
      EXPECT_EQ(coarse.report.open_edges, 0u);
      EXPECT_LE(coarse.report.depth_error_max, 0.01);
      EXPECT_LE(depth_error(coarse, surface, projection), 0.01 * 4 / 3);
      EXPECT_NEAR(covered_solid_angle(coarse.scene) / covered_solid_angle(fine.scene), 1, 1e-4);
    }
}

TEST(Inner, LooseWithoutADepthBoundIsNotGood) { // what the test above measures can fail
  RefineOptions options;
  options.depth_tolerance = 1;
  options.plain_tolerance_px = 100;
  EXPECT_GT(depth_error(convert_shape(box, curve("1-r^2"), options, raster), curve("1-r^2"), Projection::perspective), 0.02);
}

TEST(Inner, WhatIsReadDecidesWhatIsPlain) {
  RefineOptions options;
  options.skip.off_picture = false;
  const std::size_t fine = convert_shape(box, curve("1-r^2"), options, raster).report.triangles_out;
  options.plain_tolerance_px = 100;
  const Scene textured = with_texcoords(box);
  EXPECT_EQ(convert_shape(textured, curve("1-r^2"), options, raster).report.plain_faces, 0u);
  EXPECT_EQ(convert_shape(textured, curve("1-r^2"), options, raster).report.triangles_out, fine);
  options.reads = [](int, const std::string&) { return false; };
  EXPECT_EQ(convert_shape(textured, curve("1-r^2"), options, raster).report.plain_faces, 12u);
  options.vertex_colour = [](const VertexToColour& vertex) { return Vec4(vertex.eye, 1); };
  EXPECT_EQ(convert_shape(textured, curve("1-r^2"), options, raster).report.plain_faces, 0u);
}

TEST(Inner, TexturesSlideNoFartherThanTheyMay) {
  RefineOptions options;
  options.skip.off_picture = false;
  const Conversion fine = convert_shape(with_texcoords(box), curve("1-r^2"), options, raster);
  options.texture_tolerance_px = 1.5;
  options.depth_tolerance = 0.02;
  const Conversion loose = convert_shape(with_texcoords(box), curve("1-r^2"), options, raster);
  EXPECT_LT(loose.report.triangles_out, fine.report.triangles_out * 8 / 10);
  EXPECT_LE(loose.report.error_px_max, 0.5);
  EXPECT_GT(measured_error_px(loose, curve("1-r^2"), Projection::perspective, raster, 6), 0.6);
  EXPECT_LE(measured_error_px(loose, curve("1-r^2"), Projection::perspective, raster, 6), 1.5 * 4 / 3);
}

TEST(Inner, SlideDepthBoundsWhatThePlaneDoesBehindThePixel) {
  std::mt19937 random(20013);
  std::normal_distribution<double> normal;
  for (const Case& c : cases()) {
    const Surface surface(c.surface, std::sqrt(2.0));
    const ImageMap map = make_image_map(surface, Method::direct);
    const Branch& branch = map.branches[0].branch();
    const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(branch, 1e-9), {1, 1, 1, c.projection});
    const ErrorBound bound(surface, 0, branch.theta_low, branch.theta_high, c.projection);
    int tested = 0, violations = 0;
    double closest = 0;
    for (int i = 0; i < 40000; ++i) {
      const Vec3 p(normal(random), normal(random), normal(random)), n = glm::normalize(Vec3(normal(random), normal(random), normal(random)));
      const double slide = std::pow(10.0, -1.0 - 3.0 * (i % 100) / 100);
      const MappedPoint at = oracle.locate(p);
      if (at.sides[0] <= 0 || at.sides[1] <= 0) continue;
      const double limit = bound.slide_depth({at.u, at.u}, at.rho, std::abs(glm::dot(n, p)), slide);
      if (!std::isfinite(limit)) continue;
      const auto q = on_plane(surface, at.mapped.image + slide * glm::normalize(Vec2(normal(random), normal(random))), p, n);
      if (!q || oracle.locate(*q).sides[0] <= 0) continue;
      const double truth = std::abs(depth_of(oracle, p, c.projection) / depth_of(oracle, *q, c.projection) - 1);
      ++tested;
      violations += truth > limit * (1 + 1e-6) + 1e-12;
      closest = std::max(closest, truth / limit);
    }
    EXPECT_GT(tested, 500);
    EXPECT_EQ(violations, 0);
    EXPECT_GT(closest, 0.5); // the bound is not idle
  }
}

} // namespace
} // namespace domewarp
