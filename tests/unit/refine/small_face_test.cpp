// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/mesh/weld.h"
#include "domewarp/refine/small_faces.h"
#include "domewarp/refine/tolerances.h"
#include "shapes.h"

namespace domewarp {
namespace {

using Corners = std::array<Vec3, 3>;

Vec3 any(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

/// A triangle of about `size` times its distance: any, a sliver, or seen nearly edge-on.
Corners small_triangle(std::mt19937& random, int kind, double size) {
  const Vec3 at = any(random), along = glm::normalize(any(random)), across = glm::normalize(any(random));
  const double length = size * glm::length(at);
  if (kind % 3 == 0) return {at, at + length * along, at + length * across};
  if (kind % 3 == 1) return {at, at + length * along, at + length * (0.5 * along + 1e-5 * across)};
  return {at, at + length * along, at + length * (0.3 * glm::normalize(at) + 0.4 * along)};
}

struct Stage {
  Surface surface;
  ImageMap map;
  EdgeOracle oracle;
  Stage(const Case& c, double tolerance, double depth_tolerance)
      : surface(c.surface, std::sqrt(2.0)), map(make_image_map(surface, Method::automatic)),
        oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), {tolerance, tolerance / 0.97, depth_tolerance, c.projection}) {}
};

/// Nothing where a corner or the middle is clipped.
std::optional<std::array<MappedPoint, 3>> locate(const EdgeOracle& oracle, const Corners& corners) {
  std::array<MappedPoint, 3> located;
  for (int k = 0; k < 3; ++k) located[k] = oracle.locate(corners[k]);
  for (const Vec3& p : {corners[0], corners[1], corners[2], (corners[0] + corners[1] + corners[2]) / 3.0})
    for (const std::int8_t side : oracle.locate(p).sides)
      if (side <= 0) return std::nullopt;
  return located;
}

ShortSegments segments_of(const std::array<MappedPoint, 3>& p) {
  const auto length = [&](int i, int j) { return glm::length(p[i].eye - p[j].eye); };
  const auto [u_low, u_high] = std::minmax({p[0].u, p[1].u, p[2].u});
  const auto [low, high] = std::minmax({p[0].mapped.weight, p[1].mapped.weight, p[2].mapped.weight});
  return {small_angle(std::max({length(0, 1), length(1, 2), length(2, 0)}), std::min({p[0].rho, p[1].rho, p[2].rho})), u_low, u_high, low, high};
}

double depth_error(const EdgeOracle& oracle, const std::array<MappedPoint, 3>& p, const Vec3& l, Projection projection) {
  const MappedPoint exact = oracle.locate(p[0].eye * l.x + p[1].eye * l.y + p[2].eye * l.z);
  const auto depth = [&](const MappedPoint& q) { return projection == Projection::perspective ? q.mapped.weight : q.rho; };
  return std::abs((depth(p[0]) * l.x + depth(p[1]) * l.y + depth(p[2]) * l.z) / depth(exact) - 1);
}

TEST(SmallFaces, OneBoundCoversSidesAndDepth) {
  std::mt19937 random(41);
  for (const Case& c : cases()) {
    const Stage stage(c, 1e-4, 1);
    int tested = 0, violations = 0, depth_violations = 0, near = 0;
    for (int i = 0; i < 12000; ++i) {
      const auto p = locate(stage.oracle, small_triangle(random, i, 0.09 * std::pow(10.0, -2.0 * (i % 100) / 100)));
      if (!p) continue;
      const ShortSegments segments = segments_of(*p);
      const EdgeBend bend = stage.oracle.short_segments(segments);
      if (!std::isfinite(bend.second)) continue;
      ++tested;
      const double bound = bend.second / (8 * segments.weight_low);
      for (int m = 0; m <= 6; ++m)
        for (int n = 0; m + n <= 6; ++n) {
          const Vec3 l = Vec3(m, n, 6 - m - n) / 6.0;
          const bool is_inside = m > 0 && n > 0 && m + n < 6;
          const double error = stage.oracle.interior_error((*p)[0], (*p)[1], (*p)[2], l);
          violations += error > (is_inside ? 4.0 / 3.0 : 1.0) * bound * (1 + 1e-9) + 1e-12;
          near += error > 0.2 * bound;
          if (!is_inside) depth_violations += depth_error(stage.oracle, *p, l, c.projection) > bend.depth + 1e-12;
        }
    }
    const std::string name = c.surface.lens ? "lens" : c.surface.curve;
    EXPECT_GT(tested, 1000) << name;
    EXPECT_EQ(violations, 0) << name;
    EXPECT_EQ(depth_violations, 0) << name;
    EXPECT_GT(near, 0) << name << ": a fifth of it would do";
  }
}

TEST(SmallFaces, AFaceThatIsWholeHasNoSideToSplit) {
  std::mt19937 random(42);
  std::uniform_real_distribution<double> exponent(-2.5, -0.5);
  for (const Case& c : cases()) {
    const Stage stage(c, 1e-4, 0.002);
    Soup soup;
    for (std::uint32_t i = 0; i < 20000; ++i) {
      const Corners corners = small_triangle(random, static_cast<int>(i), std::pow(10.0, exponent(random)));
      soup.points.insert(soup.points.end(), corners.begin(), corners.end());
      soup.wedge_point.insert(soup.wedge_point.end(), {3 * i, 3 * i + 1, 3 * i + 2});
      soup.faces.push_back({{3 * i, 3 * i + 1, 3 * i + 2}, 0});
    }
    std::vector<MappedPoint> points;
    for (const Vec3& p : soup.points) points.push_back(stage.oracle.locate(p));
    const SiftedFaces sifted = sift_faces(soup, points, stage.oracle, {1000000, nullptr, true});
    EXPECT_GT(sifted.whole.size(), 100u);
    EXPECT_GT(sifted.refine.size(), 500u);
    for (const WholeFace& face : sifted.whole)
      for (int k = 0; k < 3; ++k) {
        const Triangle corner = points_of(soup, soup.faces[face.source]);
        const MappedPoint *a = &points[corner[k]], *b = &points[corner[(k + 1) % 3]];
        if (precedes(b->eye, a->eye)) std::swap(a, b);
        EXPECT_FALSE(stage.oracle.decide(*a, *b).split);
        EXPECT_LE(face.error, 1e-4f);
      }
    EXPECT_TRUE(sift_faces(soup, points, stage.oracle, {1000000, nullptr, false}).whole.empty());
  }
}

using Written = std::array<std::array<float, 3>, 3>;

/// The source corners of every triangle, sorted.
std::vector<Written> written_triangles(const Scene& scene) {
  std::vector<Written> all;
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
      for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        Written corners;
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t d = 0; d < 3; ++d) corners[k][d] = source[3 * primitive.indices[i + k] + d];
        all.push_back(corners);
      }
    }
  std::sort(all.begin(), all.end());
  return all;
}

void expect_the_same(const Scene& scene, const SurfaceOptions& surface, const RefineOptions& options, const Raster& raster) {
  RefineOptions every = options;
  every.skip.small_faces = false;
  const Conversion lean = convert_shape(scene, surface, options, raster), full = convert_shape(scene, surface, every, raster);
  EXPECT_EQ(written_triangles(lean.scene), written_triangles(full.scene));
  EXPECT_GT(lean.report.skipped.small_faces, 0u);
  EXPECT_EQ(full.report.skipped.small_faces, 0u);
  EXPECT_EQ(lean.report.open_edges, 0u);
  EXPECT_LE(lean.report.error_px_max, options.tolerance_px);
  EXPECT_EQ(lean.report.open_edges, full.report.open_edges);
}

/// Rough ground all around and far behind the eye, of triangles of all sizes.
Scene rough_ground() {
  std::mt19937 random(43);
  std::uniform_real_distribution<float> rough(-0.2f, 0.2f);
  constexpr int rings = 40, sectors = 60;
  Primitive primitive;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const float radius = 0.05f * std::pow(1.2f, static_cast<float>(i)), phi = 6.2831853f * static_cast<float>(j) / sectors;
      primitive.positions.push_back({radius * std::cos(phi), -1 + rough(random), radius * std::sin(phi)});
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sectors; ++j) {
      const std::uint32_t a = i * sectors + j, b = i * sectors + (j + 1) % sectors, c = a + sectors, d = b + sectors;
      primitive.indices.insert(primitive.indices.end(), {a, c, b, b, c, d});
    }
  primitive.material = 0;
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].double_sided = true;
  scene.meshes.push_back({"ground", {primitive}});
  scene.instances.push_back({"ground", 0, Mat4(1)});
  return scene;
}

TEST(SmallFaces, DrawTheSameTrianglesAsRefinementDoes) {
  for (const SurfaceOptions& surface : {curve("1-r^2"), curve("1-r"), lens(Lens::equidistant, 180), lens(Lens::equidistant, 240)})
    for (const double tolerance : {4.0, 0.5}) {
      RefineOptions options;
      options.tolerance_px = tolerance;
      expect_the_same(rough_ground(), surface, options, {512, 512});
    }
}

/// Pairs of triangles on one edge: a thin one whose third corner lies between the edge and its image, which the warp
/// turns over, and one that needs no split.
Scene turning_pairs() {
  std::mt19937 random(44);
  std::uniform_real_distribution<double> thin(-1e-3, 1e-3);
  std::vector<Vec3f> corners;
  for (int i = 0; i < 400; ++i) {
    const Vec3 at = Vec3(0, 0, -2) + 0.7 * any(random), along = glm::normalize(any(random)), across = glm::normalize(glm::cross(along, at));
    const Vec3 a = at - 0.08 * along, b = at + 0.08 * along, c = at + thin(random) * across, d = at + 0.05 * across;
    for (const Vec3& p : {a, b, c, b, a, d}) corners.emplace_back(p);
  }
  return triangles_scene(corners);
}

TEST(SmallFaces, AreWokenWhereAThinFaceBesideThemTurnsOver) {
  RefineOptions options;
  options.tolerance_px = 4;
  options.depth_tolerance = 1;
  const Raster raster{1024, 1024};
  const Scene scene = turning_pairs();
  const Soup soup = make_soup(scene, View{}, {});
  const Surface surface(curve("1-r^2"), std::sqrt(2.0));
  const ImageMap map = make_image_map(surface, Method::automatic);
  const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), oracle_options(options, raster));
  const RefinedMesh mesh = refine_levels(soup, oracle, {1000000, nullptr, true});
  EXPECT_LT(mesh.whole.size(), sift_faces(soup, mesh.points, oracle, {1000000, nullptr, true}).whole.size()) << "none was woken: nothing was tested";
  expect_the_same(scene, curve("1-r^2"), options, raster);
}

} // namespace
} // namespace domewarp
