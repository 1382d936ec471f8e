// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "shapes.h"

namespace domewarp {
namespace {

constexpr double pi = std::numbers::pi;
const Raster raster{1024, 1024};

const Scene& box() {
  static const Scene scene = box_scene({-3.1f, -1.6f, -6.3f}, {2.7f, 1.9f, 2.2f});
  return scene;
}

std::size_t triangle_count(const Scene& scene) {
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) count += primitive.indices.size() / 3;
  return count;
}

/// Solid angle of the cone of half angle theta.
double cone_solid_angle(double theta) { return 2 * pi * (1 - std::cos(theta)); }

/// A lens that shows a circle inside the picture: nothing is cut by the picture's sides.
SurfaceOptions round(Lens kind, double fov_deg) {
  SurfaceOptions options = lens(kind, fov_deg);
  options.rmax = 1;
  return options;
}

TEST(Refine, KeepsEveryPointWithinTheTolerance) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const SurfaceOptions& surface : {curve("1-r^2"), curve("3-sqrt(4+6*r^2)"), curve("1-r"), lens(Lens::equidistant, 180), lens(Lens::equidistant, 240)})
      for (const double tolerance : {2.0, 0.5}) {
        RefineOptions options;
        options.tolerance_px = tolerance;
        options.projection = projection;
        const Conversion conversion = convert_shape(box(), surface, options, raster);
        EXPECT_LE(conversion.report.error_px_max, tolerance * (1 + 1e-6));
        EXPECT_LE(measured_error_px(conversion, surface, projection, raster, 8), tolerance) << surface.curve << " at " << tolerance;
        EXPECT_EQ(conversion.report.open_edges, 0u);
        EXPECT_EQ(conversion.report.t_junctions_out, 0u);
      }
}

TEST(Refine, WithoutSubdivisionTheMeasureSeesTheError) {
  RefineOptions options;
  options.subdivision = Subdivision::none;
  EXPECT_GT(measured_error_px(convert_shape(box(), curve("1-r^2"), options, raster), curve("1-r^2"), Projection::perspective, raster, 4), 5);
}

TEST(Refine, CoversTheWholeVisibleConeOfAClosedBox) {
  for (const double fov : {60.0, 120.0, 180.0, 240.0, 330.0}) {
    const Conversion conversion = convert_shape(box(), round(Lens::equidistant, fov), {}, raster);
    const double expected = cone_solid_angle(fov / 2 * pi / 180);
    EXPECT_TRUE(conversion.report.limits_hit.empty()) << fov;
    // The rim's chords sag by at most a quarter of a pixel: 0.1 % of the circle's area.
    EXPECT_NEAR(covered_solid_angle(conversion.scene) / expected, 1, 2e-3) << fov;
  }
}

TEST(Refine, LosesNoTriangleWithAllCornersOutsideTheView) {
  // A wall of one triangle in front of the eye, far larger than the cone of 60 degrees.
  const Scene wall = triangles_scene({{-100, -90, -1}, {100, -90, -1}, {0, 200, -1}});
  const Conversion conversion = convert_shape(wall, round(Lens::equidistant, 60), {}, raster);
  EXPECT_NEAR(covered_solid_angle(conversion.scene) / cone_solid_angle(pi / 6), 1, 2e-3);
}

TEST(Refine, CutsTheBlindHoleOutOfATriangleThatSurroundsIt) {
  const Scene wall = triangles_scene({{-100, -90, 1}, {0, 200, 1}, {100, -90, 1}});
  const Conversion conversion = convert_shape(wall, round(Lens::equidistant, 300), {}, raster);
  const Scene whole = triangles_scene({{-100, -90, -1}, {100, -90, -1}, {0, 200, -1}});
  const double all = covered_solid_angle(convert_shape(whole, round(Lens::equidistant, 179), {}, raster).scene);
  EXPECT_NEAR(covered_solid_angle(conversion.scene), all - cone_solid_angle(pi / 6), 0.01 * all);
}

TEST(Refine, KeepsAFloorWhoseCornersAreAllBehindTheViewer) {
  const Scene floor = triangles_scene({{-900, -1, 500}, {900, -1, 500}, {0, -1, -800}, {-900, -1, 500}, {0, -1, -800}, {-1800, -1, -800}});
  EXPECT_GT(covered_solid_angle(convert_shape(floor, round(Lens::equidistant, 180), {}, raster).scene), 2.0);
}

TEST(Refine, SurvivesTheEyeInTheTrianglesPlaneOnItsEdgeAndOnItsVertex) {
  const std::vector<Scene> scenes = {
      triangles_scene({{-1, 0, -2}, {1, 0, -2}, {0, 0, 3}}),  // in the plane, inside
      triangles_scene({{-1, 0, 0}, {1, 0, 0}, {0, 1, -1}}),   // on the edge
      triangles_scene({{0, 0, 0}, {1, 0, -1}, {0, 1, -1}}),   // on the vertex
      triangles_scene({{-1, -1, -1}, {1, 1, 1}, {0, 3, -1}}), // an edge through the eye
      triangles_scene({{0, 0, -1}, {1, 0, -1}, {0, 1, -1}}),  // a vertex on the axis
      triangles_scene({{0, 1, 0}, {1, 0, 0}, {-1, 0, -1}}),   // vertices at exactly 90 degrees
  };
  for (const Scene& scene : scenes)
    for (const double fov : {180.0, 250.0}) {
      const Conversion conversion = convert_shape(scene, round(Lens::equidistant, fov), {}, raster);
  
      EXPECT_LE(measured_error_px(conversion, round(Lens::equidistant, fov), Projection::perspective, raster, 4), 0.51);
    }
}

TEST(Refine, TheWallThatTrapsMidpointTestsIsWithinTolerance) {
  const Scene wall = triangles_scene({{-4, -1.6f, -12}, {4, -1.6f, -12}, {4, 1.4f, -12}, {-4, -1.6f, -12}, {4, 1.4f, -12}, {-4, 1.4f, -12}});
  const Conversion conversion = convert_shape(wall, curve("1-r^2"), {}, raster);
  EXPECT_LE(measured_error_px(conversion, curve("1-r^2"), Projection::perspective, raster, 16), 0.501);
}

TEST(Refine, EqualSourcePositionsAppearAtOnePlace) {
  const Conversion conversion = convert_shape(box(), curve("1-r^2"), {}, raster);
  std::map<std::array<float, 3>, std::array<float, 3>> image_of;
  for (const Mesh& mesh : conversion.scene.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
      for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
        const Vec3f p = primitive.positions[v];
        const auto [it, is_new] = image_of.try_emplace({source[3 * v], source[3 * v + 1], source[3 * v + 2]}, std::array{p.x, p.y, p.z});
        EXPECT_EQ(it->second, (std::array{p.x, p.y, p.z}));
      }
    }
  EXPECT_LT(image_of.size(), conversion.report.vertices); // seams were there to be torn
}

TEST(Refine, MendsATJunctionOfTheSource) {
  // A long edge against two short ones; the warp would open a gap at their common vertex.
  const Scene scene = triangles_scene({{-2, 0, -1}, {2, 0, -1}, {0, 2, -1}, {0, 0, -1}, {-2, 0, -1}, {-1, -2, -1}, {2, 0, -1}, {0, 0, -1}, {1, -2, -1}});
  const Conversion conversion = convert_shape(scene, curve("1-r^2"), {}, raster);
  EXPECT_EQ(conversion.report.t_junctions_in, 1u);
  EXPECT_EQ(conversion.report.t_junctions_out, 0u);
}

TEST(Refine, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto positions = [](int threads) {
    const ThreadLimit limit(threads);
    return convert_shape(box(), curve("1-r^2"), {}, raster).scene.meshes[0].primitives[0].positions;
  };
  EXPECT_EQ(positions(1), positions(2));
}

/// Every triangle as its sorted source corners, sorted: the order of faces and corners removed.
std::vector<std::array<std::array<float, 3>, 3>> triangle_set(const Scene& scene) {
  std::vector<std::array<std::array<float, 3>, 3>> set;
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
      for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        std::array<std::array<float, 3>, 3> t;
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t c = 0; c < 3; ++c) t[k][c] = source[3 * primitive.indices[i + k] + c];
        std::sort(t.begin(), t.end());
        set.push_back(t);
      }
    }
  std::sort(set.begin(), set.end());
  return set;
}

TEST(Refine, TheOrderOfFacesAndCornersDoesNotMatter) {
  const std::vector<Vec3f>& corners = box().meshes[0].primitives[0].positions;
  std::vector<Vec3f> shuffled;
  for (std::size_t t = corners.size(); t > 0; t -= 3) {
    const std::size_t turn = t % 9 / 3;
    for (std::size_t k = 0; k < 3; ++k) shuffled.push_back(corners[t - 3 + (k + turn) % 3]);
  }
  EXPECT_EQ(triangle_set(convert_shape(box(), curve("1-r^2")).scene), triangle_set(convert_shape(triangles_scene(shuffled), curve("1-r^2")).scene));
}

TEST(Refine, SharesAnEdgeBetweenNodesThroughDifferentMatrices) {
  Scene scene = triangles_scene({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}});
  Scene other = triangles_scene({{4, 0, 0}, {4, 4, 0}, {0, 4, 0}});
  scene.meshes.push_back(other.meshes[0]);
  for (Vec3f& p : scene.meshes[1].primitives[0].positions) p -= Vec3f(8, 0, 0);
  Mat4 left(1), right(1);
  left[3] = {-2, -2, -1, 1};
  right[3] = {6, -2, -1, 1};
  scene.instances = {{"left", 0, left}, {"right", 1, right}};
  const Conversion conversion = convert_shape(scene, curve("1-r^2"), {}, raster);
  EXPECT_EQ(conversion.report.open_edges_in, 4u);
  EXPECT_EQ(conversion.report.open_edges, 0u);
}

TEST(Refine, DropsBackFacesOfSingleSidedMaterialsOnly) {
  Scene scene = triangles_scene({{-1, -1, -2}, {0, 1, -2}, {1, -1, -2}}); // clockwise for the eye
  EXPECT_GT(triangle_count(convert_shape(scene, curve("1-r^2")).scene), 0u);
  scene.materials[0].double_sided = false;
  const Conversion culled = convert_shape(scene, curve("1-r^2"));
  EXPECT_EQ(triangle_count(culled.scene), 0u);
  EXPECT_EQ(culled.report.skipped.back_faces, 1u);
}

TEST(Refine, DrawsEveryBranchOfAMultiValuedCurve) {
  // Figure 21b of the thesis: four branches (folds at 19.49, 17.12 and 17.89 degrees), so a spot 17.5 degrees off the
  // axis appears four times.
  const SurfaceOptions surface = curve("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1");
  const float r = static_cast<float>(std::tan(17.5 * pi / 180) / std::sqrt(2.0)); // towards a corner of the picture
  const Scene spot = triangles_scene({{r - 0.001f, r, -1}, {r + 0.001f, r, -1}, {r, r + 0.001f, -1}});
  const Conversion conversion = convert_shape(spot, surface, {}, raster);
  SurfaceOptions first = surface;
  first.branches = BranchChoice::first;
  EXPECT_EQ(conversion.scene.meshes[0].primitives.size(), 4u);
  EXPECT_LT(conversion.report.triangles_out, 1000u);
  EXPECT_EQ(convert_shape(spot, first, {}, raster).scene.meshes[0].primitives.size(), 1u);
}

TEST(Refine, StopsAtTheLimitAndSaysSo) {
  RefineOptions options;
  options.max_triangles = 100;
  const Conversion conversion = convert_shape(box(), curve("1-r^2"), options, raster);
  EXPECT_EQ(conversion.report.limits_hit, std::vector<std::string>{"max-triangles"});
  EXPECT_GT(conversion.report.error_px_max, options.tolerance_px);
}

TEST(Refine, GivesEveryEdgeTheSameLargerToleranceWhenTheTrianglesAreLimited) {
  RefineOptions options;
  options.max_triangles = 800;
  const Conversion conversion = convert_shape(box(), lens(Lens::equidistant, 180), options, raster);
  EXPECT_EQ(conversion.report.limits_hit, std::vector<std::string>{"max-triangles"});
  EXPECT_LE(conversion.report.triangles_out, options.max_triangles);
  EXPECT_GT(conversion.report.error_px_max, options.tolerance_px);
  EXPECT_LT(conversion.report.error_px_max, 4); // a mesh cut off at the limit is hundreds of pixels wrong
  EXPECT_LE(measured_error_px(conversion, lens(Lens::equidistant, 180), Projection::perspective, raster, 8), 1.05 * conversion.report.error_px_max);
}

TEST(Refine, RefusesAToleranceThatIsNotPositive) {
  RefineOptions options;
  options.tolerance_px = -1;
  EXPECT_THROW(convert_shape(box(), curve("1-r^2"), options, raster), Error);
}

} // namespace
} // namespace domewarp
