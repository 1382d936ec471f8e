// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "domewarp/convert/live.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"

namespace domewarp {
namespace {

constexpr unsigned seed = 7;

/// Many small triangles all around the origin in two meshes, one of them drawn twice.
Scene crowd(std::size_t triangles) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-5, 5), off(-0.3F, 0.3F);
  Scene scene;
  for (int m = 0; m < 2; ++m) {
    Primitive primitive;
    for (std::size_t t = 0; t < triangles; ++t) {
      const Vec3f centre(place(random), place(random), place(random));
      for (int c = 0; c < 3; ++c) {
        primitive.indices.push_back(static_cast<std::uint32_t>(primitive.positions.size()));
        primitive.positions.push_back(centre + Vec3f(off(random), off(random), off(random)));
      }
    }
    scene.meshes.push_back({"mesh", {primitive, primitive}});
    scene.instances.push_back({"node", m, Mat4(1)});
  }
  scene.instances.push_back({"again", 0, glm::translate(Mat4(1), Vec3(1, 2, 3))});
  return scene;
}

ConvertOptions dome() {
  ConvertOptions options;
  options.surface.lens = Lens::equidistant;
  options.surface.fov_deg = 200;
  options.raster = {1024, 1024};
  options.view.eye = Vec3(0.1, 0.2, 0.3);
  options.view.forward = Vec3(1, 2, -3);
  options.refine.source_attributes = true;
  return options;
}

View moved(const View& view) {
  View other = view;
  other.eye += Vec3(0.5, -0.25, 0.125);
  return other;
}

Vec2 image_of(const Vec3f& warped) { return Vec2(warped.x, warped.y) / -static_cast<double>(warped.z); }

/// Single precision of the eye-space position, and of what is written.
double bound(const BatchMap& map) { return map.report().predicted_error + 1e-6; }

TEST(Live, GivesTheImagePointsOfConvert) {
  const ConvertOptions options = dome();
  const Display display = make_display(options.surface, options.raster, options.method);
  ConvertReport report;
  const Scene warped = convert(crowd(500), options, display, report);
  const LiveMesh mesh = make_live_mesh(warped, report);
  const BatchMap map(display.surface);
  ASSERT_TRUE(map.report().vectorised);
  std::vector<Vec3f> out(mesh.positions.size());
  rewarp(mesh, report.view, map, BatchOutput::perspective, out);

  double worst = 0;
  for (const LivePart& part : mesh.parts) {
    const auto& positions = warped.meshes[warped.instances[part.instance].mesh].primitives[part.primitive].positions;
    ASSERT_EQ(positions.size(), part.count);
    for (std::size_t i = 0; i < part.count; ++i) worst = std::max(worst, glm::length(image_of(out[part.first + i]) - image_of(positions[i])));
  }
  EXPECT_GT(out.size(), 1000u);
  EXPECT_LT(worst, bound(map)) << "largest difference in image units";
  RecordProperty("largest_difference", std::to_string(worst));

  // Negative control: another eye sees other points.
  rewarp(mesh, moved(report.view), map, BatchOutput::perspective, out);
  const auto& first = warped.meshes[warped.instances[mesh.parts[0].instance].mesh].primitives[mesh.parts[0].primitive].positions;
  EXPECT_GT(glm::length(image_of(out[0]) - image_of(first[0])), 1e-3);
}

TEST(Live, FollowsTheEyeAsTheExactMapDoes) {
  const Scene scene = crowd(700);
  SurfaceOptions options;
  options.curve = "1-r^2";
  const Surface surface(options, 1);
  const ImageMap exact = make_image_map(surface, Method::direct);
  const BatchMap map(surface);
  const LiveMesh mesh = make_live_mesh(scene);
  View view;
  view.eye = Vec3(0.25, -0.5, 1);
  std::vector<Vec3f> out(mesh.positions.size());
  rewarp(mesh, view, map, BatchOutput::image, out);
  std::size_t visible = 0, i = 0;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
      for (const Vec3f& position : primitive.positions) {
        const Vec3f& found = out[i++];
        const ImagePoint expected = project(surface, exact, to_eye(view, to_world(instance.world, position)));
        if (expected.state != PointState::visible) continue;
        ++visible;
        ASSERT_LT(glm::length(Vec2(found.x, found.y) - Vec2(expected.x, expected.y)), bound(map)) << "seed " << seed << ", vertex " << i - 1;
        ASSERT_NEAR(found.z, expected.depth, 1e-6 * expected.depth);
      }
  EXPECT_EQ(i, out.size());
  EXPECT_GT(visible, 1000u);
}

TEST(Live, MovesAPartWithItsMatrix) {
  const Scene scene = crowd(10);
  LiveMesh mesh = make_live_mesh(scene);
  SurfaceOptions options;
  options.lens = Lens::equidistant;
  const BatchMap map{Surface(options, 1)};
  std::vector<Vec3f> before(mesh.positions.size()), after(mesh.positions.size());
  rewarp(mesh, View{}, map, BatchOutput::image, before);
  mesh.parts[1].world = glm::translate(Mat4(1), Vec3(0, 1, 0));
  rewarp(mesh, View{}, map, BatchOutput::image, after);
  for (std::size_t p = 0; p < mesh.parts.size(); ++p)
    EXPECT_EQ(before[mesh.parts[p].first] == after[mesh.parts[p].first], p != 1) << "part " << p;
}

TEST(Live, GivesTheSameBytesForAnyNumberOfThreads) {
  const LiveMesh mesh = make_live_mesh(crowd(3000));
  SurfaceOptions options;
  options.lens = Lens::stereographic;
  const BatchMap map{Surface(options, 1)};
  std::vector<Vec3f> one(mesh.positions.size()), all(mesh.positions.size());
  with_threads(1, [&] { rewarp(mesh, View{}, map, BatchOutput::perspective, one); });
  rewarp(mesh, View{}, map, BatchOutput::perspective, all);
  EXPECT_EQ(std::memcmp(one.data(), all.data(), all.size() * sizeof(Vec3f)), 0);
}

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(Live, SaysWhatItCannotPrepare) {
  ConvertOptions options = dome();
  options.refine.source_attributes = false;
  ConvertReport report;
  const Scene bare = convert(crowd(50), options, report);
  EXPECT_THAT(refusal([&] { make_live_mesh(bare, report); }), testing::HasSubstr("has no _SOURCE_POSITION"));

  report.branches.resize(2);
  EXPECT_THAT(refusal([&] { make_live_mesh(bare, report); }), testing::HasSubstr("on up to 2 branches"));

  const LiveMesh mesh = make_live_mesh(crowd(1));
  const BatchMap map{Surface(options.surface, 1)};
  std::vector<Vec3f> small(1);
  EXPECT_THAT(refusal([&] { rewarp(mesh, View{}, map, BatchOutput::image, small); }), testing::HasSubstr("must have room for 18 points, got 1"));
}

} // namespace
} // namespace domewarp
