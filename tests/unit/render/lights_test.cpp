// SPDX-License-Identifier: Apache-2.0
// The scene's own lights: what arrives, the same in both renderers, and what stands in the way.
#include <cmath>
#include <numbers>

#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "render_scenes.h"

namespace domewarp {
namespace {

using namespace test;

Light make_light(LightKind kind, const Vec3& position, double intensity) {
  Light light;
  light.kind = kind;
  light.world = glm::translate(Mat4(1), position);
  light.intensity = intensity;
  return light;
}

/// A white wall two metres before the eye.
Scene make_wall() {
  Scene scene;
  add(scene, make_quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, add_material(scene, Vec4(1))));
  return scene;
}

Frame trace(const Scene& scene, bool shadows = false, const std::string& embree = "") {
  const Display display = make_display("1", 65, 65);
  RayTraceOptions options;
  options.lights = true;
  options.shadows = shadows;
  options.layers = Layers::all;
  options.embree = embree;
  return ray_trace(scene, View{}, display.surface, display.raster, options);
}

float centre(const Frame& frame) {
  return frame.light[32 * 65 + 32].x;
}

TEST(Lights, IrradianceFollowsTheInverseSquareAndTheCosine) {
  Scene scene = make_wall();
  scene.lights = {make_light(LightKind::point, {0, 0, 0}, std::numbers::pi)};
  EXPECT_NEAR(centre(trace(scene)), 0.25, 1e-5);
  scene.lights = {make_light(LightKind::point, {3, 0, 2}, std::numbers::pi)}; // 5 away, cosine 4/5
  EXPECT_NEAR(centre(trace(scene)), 0.8 / 25, 1e-5);
  scene.lights = {make_light(LightKind::point, {0, 0, -3}, 100)}; // behind the wall
  EXPECT_EQ(centre(trace(scene)), 0);
  scene.lights = {make_light(LightKind::directional, {7, 7, 7}, 0.5 * std::numbers::pi)};
  EXPECT_NEAR(centre(trace(scene)), 0.5, 1e-5);
}

TEST(Lights, RangeAndConeEndTheLight) {
  Scene scene = make_wall();
  scene.lights = {make_light(LightKind::point, {0, 0, 0}, std::numbers::pi)};
  scene.lights[0].range = 4;
  EXPECT_NEAR(centre(trace(scene)), 0.25 * (1 - 1.0 / 16), 1e-5);
  scene.lights[0].range = 1.9;
  EXPECT_EQ(centre(trace(scene)), 0);
  scene.lights = {make_light(LightKind::spot, {0, 0, 0}, std::numbers::pi)};
  scene.lights[0].outer_cone = 0.3;
  const Frame frame = trace(scene);
  EXPECT_NEAR(centre(frame), 0.25, 1e-5);
  EXPECT_EQ(frame.light[32 * 65 + 32 + 12].x, 0) << "20 degrees off";
}

TEST(Lights, OpaqueThingsCastShadowsAndBlendedOnesDoNot) {
  Scene scene = make_wall();
  scene.lights = {make_light(LightKind::point, {0, 3, 0}, 100)};
  // On the way from the light to the middle of the wall, above what the eye sees; its back to the light.
  const Mesh board = make_quad({-0.2, 1.3, -1}, {0.4, 0, 0}, {0, 0.4, 0}, add_material(scene, Vec4(1)));
  const float lit = centre(trace(scene, true));
  EXPECT_GT(lit, 0);
  add(scene, board);
  EXPECT_EQ(centre(trace(scene, true)), 0);
  EXPECT_EQ(centre(trace(scene, false)), lit);
  scene.materials[1].alpha_mode = AlphaMode::blend;
  EXPECT_EQ(centre(trace(scene, true)), lit);
}

TEST(Lights, ALitRoomHasNoSpeckles) {
  Scene scene = make_room();
  scene.lights = {make_light(LightKind::point, {0.3, 0.2, -0.1}, 10)};
  const Frame lit = trace(scene, false), shadowed = trace(scene, true);
  EXPECT_EQ(lit.rgba, shadowed.rgba) << "nothing stands in a convex room";
}

TEST(Lights, ShadowsDoNotDependOnTheInstructionSet) {
  Scene scene = make_room_with_board();
  scene.lights = {make_light(LightKind::point, {0.7, 1.2, 0.3}, 10), make_light(LightKind::directional, {}, 1)};
  const Frame reference = trace(scene, true, "isa=sse4.2");
  for (const std::string isa : {"avx2", "avx512"}) EXPECT_TRUE(is_same(reference, trace(scene, true, "isa=" + isa))) << isa;
}

TEST(Lights, BothRenderersAgree) {
  Scene scene = make_room_with_board();
  scene.materials.back().double_sided = true;
  scene.lights = {make_light(LightKind::point, {0.7, 1.2, 0.3}, 6), make_light(LightKind::spot, {-1, 0.5, 1}, 9),
                  make_light(LightKind::directional, {}, 1)};
  scene.lights[0].range = 5;
  scene.lights[1].outer_cone = 0.6;
  scene.lights[1].inner_cone = 0.2;
  const Display display = make_display("1-r^2", 120, 80);
  RayTraceOptions rays;
  rays.lights = true;
  rays.exposure = 0.5;
  RasterOptions raster;
  raster.lights = place_lights(scene, Mat4(1));
  raster.exposure = 0.5;
  const Frame a = ray_trace(scene, View{}, display.surface, display.raster, rays);
  const Frame b = rasterise(prewarp(scene, display, 48), display.raster, raster);
  int worst = 0, brightest = 0;
  for (int row = 0; row < 80; ++row)
    for (int column = 0; column < 120; ++column) {
      if (is_outline(a, column, row)) continue;
      const std::size_t i = 4 * std::size_t(row * 120 + column);
      for (std::size_t k = i; k < i + 3; ++k) {
        worst = std::max(worst, std::abs(int(a.rgba[k]) - int(b.rgba[k])));
        brightest = std::max(brightest, int(a.rgba[k]));
      }
    }
  EXPECT_LE(worst, 4);
  EXPECT_GT(brightest, 100);
}

TEST(Lights, ASceneWithoutLightsIsRefused) {
  EXPECT_THROW(trace(make_wall()), Error);
}

} // namespace
} // namespace domewarp
