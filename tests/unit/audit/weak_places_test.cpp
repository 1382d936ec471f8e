// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes of 6 to 20 vertices on which subdivision in space, projection and clipping are weakest, judged by the audit: no
// crack, no torn vertex, no flip, nothing lost, no sample farther off than the tolerance.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "../refine/shapes.h"
#include "domewarp/audit/inspect.h"
#include "domewarp/core/parallel.h"

namespace domewarp {
namespace {

const Raster raster{1024, 1024};

struct Judged {
  RefineReport refined;
  InspectReport audit;
};

Judged judge(const Scene& scene, const SurfaceOptions& options, const RefineOptions& refine_options = {}) {
  Surface surface(options, screen_radius(raster));
  ImageMap map = make_image_map(surface, Method::direct);
  const Conversion conversion = convert_shape(scene, options, refine_options, raster);
  const Picture picture{std::move(surface), std::move(map), View{}, raster, refine_options.projection == Projection::perspective, conversion.report.near};
  return {conversion.report, inspect(conversion.scene, {&picture, &scene, 5'000})};
}

struct Expected {
  std::size_t least_samples = 1;
};

/// Every surface, both projections: sound, and no sample farther off than the tolerance.
void expect_sound(const Scene& scene, const Expected& expected = {}) {
  // Through the last, the picture wraps around the backward direction.
  const std::vector<SurfaceOptions> surfaces = {curve("1-r^2"), curve("3-sqrt(4+6*r^2)"), curve("1-2.5*r^2"), lens(Lens::equidistant, 120), lens(Lens::equidistant, 180), lens(Lens::equidistant, 270)};
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const SurfaceOptions& surface : surfaces) {
      RefineOptions options;
      options.projection = projection;
      const Judged judged = judge(scene, surface, options);
      const std::string name = surface.curve + (surface.lens ? "lens " + std::to_string(surface.fov_deg) : "") +
                               (projection == Projection::perspective ? ", perspective" : ", orthographic");
      EXPECT_TRUE(is_sound(judged.audit)) << name << "\n" << to_text(judged.audit);
      EXPECT_GE(judged.audit.coverage->samples, expected.least_samples) << name;
      EXPECT_LE(judged.audit.coverage->error_px_max, options.tolerance_px) << name;
      EXPECT_TRUE(judged.refined.limits_hit.empty()) << name;
    }
}

TEST(WeakPlaces, TheEdgeWhoseErrorVanishesAtItsMiddle) {
  // The line through the axis from (0,-1,1) to (0,1,1): its image has its inflection in the middle, so tests there see nothing.
  expect_sound(triangles_scene({{0, -1, -1}, {0, 1, -1}, {1, 0, -1}, {0, 1, -1}, {0, -1, -1}, {-1, 0, -1}}));
}

TEST(WeakPlaces, TheWallWhoseDiagonalTrapsMidpointTests) {
  expect_sound(triangles_scene({{-4, -1.6f, -12}, {4, -1.6f, -12}, {4, 1.4f, -12}, {-4, -1.6f, -12}, {4, 1.4f, -12}, {-4, 1.4f, -12}}));
}

TEST(WeakPlaces, ThreeTrianglesOnOneEdge) {
  // A shelf that meets a wall in the middle of two of the wall's faces.
  expect_sound(triangles_scene({{-2, 0, -2}, {2, 0, -2}, {0, 2, -2}, {2, 0, -2}, {-2, 0, -2}, {0, -2, -2}, {-2, 0, -2}, {2, 0, -2}, {0, 0.5f, -1}}));
}

TEST(WeakPlaces, AMoebiusStrip) {
  // Five triangles on five vertices: no orientation fits, so a half-edge structure refuses one of them.
  std::vector<Vec3f> ring, corners;
  for (int i = 0; i < 5; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(2 * i) / 5;
    ring.emplace_back(std::cos(angle), std::sin(angle), -2 - 0.3f * static_cast<float>(i));
  }
  for (std::size_t i = 0; i < 5; ++i) corners.insert(corners.end(), {ring[i], ring[(i + 1) % 5], ring[(i + 2) % 5]});
  expect_sound(triangles_scene(corners));
}

TEST(WeakPlaces, BowTiesAndDegenerateFaces) {
  // Two triangles that share a vertex only, and two that cover nothing: a repeated corner, and three corners on a line.
  expect_sound(triangles_scene({{0, 0, -1}, {1, 1, -1}, {-1, 1, -1}, {0, 0, -1}, {-1, -1, -1}, {1, -1, -1},
                                {0, 0, -1}, {0, 0, -1}, {1, 0, -1}, {-1, 1, -1}, {0, 1, -1}, {1, 1, -1}}));
}

TEST(WeakPlaces, TwoPrimitivesThatShareAnEdgeWithDifferentTextureCoordinates) {
  Scene scene = triangles_scene({{-2, -2, -1}, {2, -2, -1}, {2, 2, -1}});
  Primitive other = triangles_scene({{-2, -2, -1}, {2, 2, -1}, {-2, 2, -1}}).meshes[0].primitives[0];
  scene.meshes[0].primitives[0].attributes.push_back({"TEXCOORD_0", 2, {0, 0, 1, 0, 1, 1}});
  other.attributes.push_back({"TEXCOORD_0", 2, {0.5f, 0, 0.25f, 1, 0, 1}});
  scene.meshes[0].primitives.push_back(other);
  expect_sound(scene, {.least_samples = 100});
}

TEST(WeakPlaces, TwoNodesThatShareAnEdgeThroughDifferentMatrices) {
  // A tile modelled once and laid twice; turned by a right angle, its corners come out equal to the bit.
  Scene scene = triangles_scene({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 0, 0}, {4, 4, 0}, {0, 4, 0}});
  Mat4 left(1), right(0);
  left[3] = {-4, -2, -1, 1};
  right[0] = {0, 1, 0, 0};
  right[1] = {-1, 0, 0, 0};
  right[2] = {0, 0, 1, 0};
  right[3] = {4, -2, -1, 1};
  scene.instances = {{"left", 0, left}, {"right", 0, right}};
  expect_sound(scene, {.least_samples = 100});
}

TEST(WeakPlaces, AFloorWhoseCornersAreAllBehindTheViewer) {
  expect_sound(triangles_scene({{-900, -1, 500}, {900, -1, 500}, {0, -1, -800}, {-900, -1, 500}, {0, -1, -800}, {-1800, -1, -800}}));
  expect_sound(triangles_scene({{-1, -1, 0.2f}, {1, -1, 0.2f}, {0, 30, 0.2f}, {0, -20, -9}, {9, 5, 0.5f}, {-9, 5, 0.5f}}), {.least_samples = 0});
}

TEST(WeakPlaces, ATriangleAroundTheBackwardDirection) { expect_sound(triangles_scene({{-3, -2, 1}, {0, 4, 1}, {3, -2, 1}}), {.least_samples = 0}); }

TEST(WeakPlaces, ATriangleTwiceAcrossTheCone) {
  // Both ends of its long side are outside the cone of 60 degrees, the middle is inside.
  const Scene beam = triangles_scene({{-4, -0.1f, -1}, {4, -0.1f, -1}, {0, 0.1f, -1}});
  expect_sound(beam);
  EXPECT_TRUE(is_sound(judge(beam, lens(Lens::equidistant, 60)).audit));
}

TEST(WeakPlaces, TheEyeInATrianglesPlaneOnItsEdgeAndOnItsVertex) {
  for (const std::vector<Vec3f>& corners : {std::vector<Vec3f>{{-1, 0, -2}, {1, 0, -2}, {0, 0, 3}}, {{-1, 0, 0}, {1, 0, 0}, {0, 1, -1}},
                                            {{0, 0, 0}, {1, 0, -1}, {0, 1, -1}}, {{-1, -1, -1}, {1, 1, 1}, {0, 3, -1}},
                                            {{0, 0, -1}, {1, 0, -1}, {0, 1, -1}}, {{0, 1, 0}, {1, 0, 0}, {-1, 0, -1}}})
    expect_sound(triangles_scene(corners), {.least_samples = 0});
}

TEST(WeakPlaces, TheBoxOfTenByOneByOne) {
  // Splitting by face length opened 144 edges of this box in a well-known library.
  expect_sound(box_scene({-5, -0.5f, -0.5f}, {5, 0.5f, 0.5f}), {.least_samples = 100});
  expect_sound(box_scene({-5, -0.5f, -3.5f}, {5, 0.5f, -2.5f}), {.least_samples = 100});
}

TEST(WeakPlaces, ASliverOfAMillionToOne) {
  expect_sound(triangles_scene({{-5, 0.3f, -1}, {5, 0.3f, -1}, {0, 0.30001f, -1}, {5, 0.3f, -1}, {-5, 0.3f, -1}, {0, -2, -1}}));
}

TEST(WeakPlaces, TwentyNineKilometresAndAMillimetre) {
  // A landscape's triangle and a grain of sand in front of the eye.
  expect_sound(triangles_scene({{-29000, -2, 10000}, {29000, -2, 10000}, {0, -2, -29000}, {0.0002f, 0, -0.01f}, {0.0012f, 0, -0.01f}, {0.0002f, 0.001f, -0.01f}}));
}

TEST(WeakPlaces, ASourceTJunction) {
  // A long side against two short ones; the warp would open a gap at their common corner.
  expect_sound(triangles_scene({{-2, 0, -1}, {2, 0, -1}, {0, 2, -1}, {0, 0, -1}, {-2, 0, -1}, {-1, -2, -1}, {2, 0, -1}, {0, 0, -1}, {1, -2, -1}}));
}

TEST(WeakPlaces, AThinFaceSeenNearlyEdgeOnDoesNotTurnOver) {
  // A strip of 0.02 on the floor just below the eye: its sides bend farther in the picture than it is thick.
  std::vector<Vec3f> corners;
  for (int i = 0; i < 3; ++i) {
    const float z = -1 - 0.02f * static_cast<float>(i);
    corners.insert(corners.end(), {Vec3f(-2, -0.02f, z), Vec3f(2, -0.02f, z), Vec3f(2, -0.02f, z - 0.02f), Vec3f(-2, -0.02f, z), Vec3f(2, -0.02f, z - 0.02f), Vec3f(-2, -0.02f, z - 0.02f)});
  }
  expect_sound(triangles_scene(corners));
}

TEST(WeakPlaces, WithoutRefinementTheseShapesFail) {
  // The judge's own control: the wall left as it is.
  RefineOptions options;
  options.subdivision = Subdivision::none;
  const Scene wall = triangles_scene({{-4, -1.6f, -12}, {4, -1.6f, -12}, {4, 1.4f, -12}, {-4, -1.6f, -12}, {4, 1.4f, -12}, {-4, 1.4f, -12}});
  EXPECT_GT(judge(wall, curve("1-r^2"), options).audit.coverage->error_px_max, 5);
}

using TriangleSet = std::vector<std::array<std::array<float, 6>, 3>>;

/// Every written triangle as its corners (source and picture), sorted: the order of faces and corners removed.
TriangleSet triangle_set(const Scene& scene) {
  TriangleSet set;
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
      for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        auto& triangle = set.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t v = primitive.indices[i + k];
          const Vec3f p = primitive.positions[v];
          triangle[k] = {source[3 * v], source[3 * v + 1], source[3 * v + 2], p.x, p.y, p.z};
        }
        std::sort(triangle.begin(), triangle.end());
      }
    }
  std::sort(set.begin(), set.end());
  return set;
}

/// A hollow box with a shelf, a T-junction, a shared corner and a nearly edge-on strip.
std::vector<Vec3f> cluttered_room() {
  std::vector<Vec3f> corners = box_scene({-3.1f, -1.6f, -6.3f}, {2.7f, 1.9f, 2.2f}).meshes[0].primitives[0].positions;
  for (const Vec3f& p : {Vec3f(-2, 0, -2), Vec3f(2, 0, -2), Vec3f(0, 2, -2), Vec3f(0, 0, -2), Vec3f(-2, 0, -2), Vec3f(-1, -2, -2),
                         Vec3f(2, 0, -2), Vec3f(0, 0, -2), Vec3f(1, -2, -2), Vec3f(-2, 0, -2), Vec3f(0, 0, -2), Vec3f(0, 0.1f, -1),
                         Vec3f(-2, -0.02f, -1), Vec3f(2, -0.02f, -1), Vec3f(2, -0.02f, -1.02f)})
    corners.push_back(p);
  return corners;
}

TEST(WeakPlaces, PermutedFacesTurnedCornersAndReversedWindingGiveTheSameTriangles) {
  const std::uint32_t seed = 1701;
  std::mt19937 random(seed);
  const std::vector<Vec3f> corners = cluttered_room();
  for (const auto& [surface, projection] : {std::pair(curve("1-r^2"), Projection::perspective), std::pair(lens(Lens::equidistant, 270), Projection::perspective),
                                            std::pair(curve("1-r^2"), Projection::orthographic)}) {
    RefineOptions options;
    options.projection = projection;
    const TriangleSet expected = triangle_set(convert_shape(triangles_scene(corners), surface, options, raster).scene);
    for (int trial = 0; trial < 4; ++trial) {
      std::vector<std::size_t> order(corners.size() / 3);
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
      std::shuffle(order.begin(), order.end(), random);
      std::vector<Vec3f> shuffled;
      for (const std::size_t face : order) {
        const std::size_t turn = random() % 3;
        const bool reversed = random() % 2 == 0;
        for (std::size_t k = 0; k < 3; ++k) shuffled.push_back(corners[3 * face + (turn + (reversed ? 3 - k : k)) % 3]);
      }
      EXPECT_EQ(triangle_set(convert_shape(triangles_scene(shuffled), surface, options, raster).scene), expected) << "trial " << trial << ", seed " << seed;
    }
  }
}

TEST(WeakPlaces, OneToEightThreadsGiveTheSameVertices) {
  const Scene scene = triangles_scene(cluttered_room());
  const auto positions = [&](int threads) {
    const ThreadLimit limit(threads);
    RefineOptions options;
    options.tolerance_px = 0.1;
    const Conversion conversion = convert_shape(scene, curve("1-r^2"), options, raster);
    return std::pair(conversion.scene.meshes[0].primitives[0].positions, conversion.scene.meshes[0].primitives[0].indices);
  };
  const auto one = positions(1);
  for (int threads = 2; threads <= 8; ++threads) EXPECT_EQ(positions(threads), one) << threads;
}

} // namespace
} // namespace domewarp
