// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/convert/convert.h"

namespace domewarp {
namespace {

using testing::Contains;
using testing::HasSubstr;

Light light(LightKind kind, const Vec3& shines) {
  Light light;
  light.kind = kind;
  light.world[2] = Vec4(-shines, 0);
  light.world[3] = Vec4(4, 5, 6, 1);
  light.intensity = 3;
  return light;
}

Scene lit_square() {
  Scene scene;
  Primitive primitive;
  primitive.positions = {{-1, -1, -2}, {1, -1, -2}, {1, 1, -2}, {-1, 1, -2}};
  primitive.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back({"square", {primitive}});
  scene.instances.push_back({"square", 0, Mat4(1)});
  scene.lights = {light(LightKind::point, {0, 0, -1}), light(LightKind::directional, {1, 0, 0})};
  return scene;
}

ConvertOptions looking_along(const Vec3& forward) {
  ConvertOptions options;
  options.surface.lens = Lens::equidistant;
  options.surface.fov_deg = 300;
  options.raster = {256, 256};
  options.view.eye = Vec3(0);
  options.view.forward = forward;
  return options;
}

TEST(Shading, TurnsDirectionalLightsIntoEyeSpace) {
  ConvertReport report;
  const Scene warped = convert(lit_square(), looking_along({1, 0, 0}), report);
  ASSERT_EQ(warped.lights.size(), 1u);
  EXPECT_EQ(warped.lights[0].kind, LightKind::directional);
  EXPECT_EQ(warped.lights[0].intensity, 3);
  const Vec3 shines = -Vec3(warped.lights[0].world[2]); // it shone where the eye looks: along -z of eye space
  EXPECT_NEAR(glm::length(shines - Vec3(0, 0, -1)), 0, 1e-12);
}

TEST(Shading, NamesTheLightsThatCannotBeKept) {
  ConvertReport report;
  convert(lit_square(), looking_along({0, 0, -1}), report);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("left out 1 point or spot light(s)")));
}

TEST(Shading, WritesNoLightsForUnlitMaterials) {
  ConvertOptions options = looking_along({0, 0, -1});
  options.shading = Shading::unlit;
  ConvertReport report;
  EXPECT_TRUE(convert(lit_square(), options, report).lights.empty());
}

} // namespace
} // namespace domewarp
