// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "domewarp/convert/convert.h"
#include "domewarp/convert/report.h"
#include "domewarp/scene/test_scenes.h"

namespace domewarp {
namespace {

Scene triangle() {
  Primitive primitive;
  primitive.positions = {{-1, -1, -3}, {1, -1, -3}, {0, 1, -3}};
  primitive.indices = {0, 1, 2};
  Scene scene;
  scene.meshes.push_back({"triangle", {primitive}});
  scene.instances.push_back({"triangle", 0, Mat4(1)});
  scene.materials.emplace_back();
  return scene;
}

Scene cubes() { return make_test_scenes().front().scene; }

nlohmann::json report_of(const Scene& scene, Method method, const char* curve = "1-r^2") {
  ConvertOptions options;
  options.surface.curve = curve;
  options.raster = {64, 64};
  options.view.eye = Vec3(0);
  options.view.target = Vec3(0, 0, -1);
  options.method = method;
  ConvertReport report;
  convert(scene, options, report);
  return nlohmann::json::parse(to_json(report, options));
}

TEST(ConvertMethod, AutomaticGoesByTheNumberOfVerticesAndSaysSo) {
  const nlohmann::json few = report_of(triangle(), Method::automatic);
  EXPECT_EQ(few["method"]["asked"], "auto");
  EXPECT_EQ(few["method"]["used"], "direct");
  EXPECT_EQ(few["method"]["expected_points"], 128) << "64 rows, half a pixel";
  EXPECT_EQ(few["surface"]["branches"][0]["method_reason"], to_string(TableReason::few_points));
  const nlohmann::json many = report_of(cubes(), Method::automatic);
  EXPECT_EQ(many["method"]["used"], "lut");
  EXPECT_EQ(many["surface"]["branches"][0]["method_reason"], to_string(TableReason::used));
}

TEST(ConvertMethod, ExpectsAsManyPointsAsTheViewNeedsPieces) {
  ConvertOptions options;
  options.raster = {4096, 4096};
  EXPECT_EQ(expected_points(triangle(), options), 8192u);
  EXPECT_GE(expected_points(cubes(), options), 10 * count_vertices(cubes()));
  options.refine.subdivision = Subdivision::isotropic;
  EXPECT_EQ(expected_points(triangle(), options), 30u);
  options.refine.subdivision = Subdivision::none;
  EXPECT_EQ(expected_points(triangle(), options), 3u);
}

TEST(ConvertMethod, IsAsAskedFor) {
  EXPECT_EQ(report_of(triangle(), Method::table)["method"]["used"], "lut");
  const nlohmann::json direct = report_of(cubes(), Method::direct);
  EXPECT_EQ(direct["method"]["used"], "direct");
  EXPECT_EQ(direct["surface"]["branches"][0]["method_reason"], to_string(TableReason::direct_asked));
}

} // namespace
} // namespace domewarp
