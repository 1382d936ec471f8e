// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "domewarp/audit/drawn.h"
#include "domewarp/audit/inspect.h"

namespace domewarp {
namespace {

/// One mesh of triangles over `positions`.
Scene scene_of(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices) {
  Scene scene;
  Primitive primitive;
  primitive.positions = positions;
  primitive.indices = indices;
  scene.meshes.push_back({"shape", {primitive}});
  scene.instances.push_back({"shape", 0, Mat4(1)});
  return scene;
}

const std::vector<Vec3f> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<std::uint32_t> tetrahedron = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};

TEST(Inspect, AClosedMeshHasNoOpenEdge) {
  const InspectReport report = inspect(scene_of(corners, tetrahedron));
  EXPECT_EQ(report.triangles, 4u);
  EXPECT_EQ(report.unique_positions, 4u);
  EXPECT_EQ(report.open_edges + report.non_manifold_edges + report.degenerate + report.duplicate + report.t_junctions, 0u);
}

TEST(Inspect, AMissingTriangleOpensThreeEdges) {
  EXPECT_EQ(inspect(scene_of(corners, {0, 2, 1, 0, 1, 3, 1, 2, 3})).open_edges, 3u);
}

TEST(Inspect, ACollapsedTriangleClosesTheEdgeBesideIt) {
  EXPECT_EQ(use_edges({{0, 1, 2}}).open.size(), 3u);
  EXPECT_EQ(use_edges({{0, 1, 2}, {1, 1, 2}}).open, (std::vector<Ends>{{0, 1}, {0, 2}}));
  EXPECT_EQ(use_edges({{3, 3, 3}}).open.size(), 0u);
}

TEST(Inspect, CountsDuplicateDegenerateAndNonManifold) {
  std::vector<std::uint32_t> indices = tetrahedron;
  indices.insert(indices.end(), {0, 1, 2, 0, 0, 1});
  const InspectReport report = inspect(scene_of(corners, indices));
  EXPECT_EQ(report.duplicate, 1u);
  EXPECT_EQ(report.degenerate, 1u);
  EXPECT_EQ(report.non_manifold_edges, 3u);
}

TEST(Inspect, SeamsAreWeldedByPositionAcrossNodes) {
  Scene scene = scene_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2});
  scene.meshes.push_back(scene_of({{0, 0, 0}, {-1, 1, 0}, {-1, 0, 0}}, {0, 1, 2}).meshes[0]);
  Mat4 shifted(1);
  shifted[3] = {1, 0, 0, 1};
  scene.instances.push_back({"other", 1, shifted});
  const InspectReport report = inspect(scene);
  EXPECT_EQ(report.unique_positions, 3u);
  EXPECT_EQ(report.duplicate, 1u);
}

TEST(Inspect, FindsAVertexInsideAnOpenEdge) {
  const InspectReport report = inspect(scene_of({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, -1, 0}}, {0, 1, 2, 3, 0, 4}));
  EXPECT_EQ(report.t_junctions, 1u);
}

/// Two triangles that share an edge in the source, drawn through the camera of a warped file; `shift` tears them.
Scene warped_pair(float shift) {
  Scene scene = scene_of({{0, 0, -1}, {1, 0, -1}, {0, 1, -1}, {1, 0, -1}, {1, 1, -1}, {shift, 1, -1}}, {0, 1, 2, 3, 4, 5});
  Attribute source{"_SOURCE_POSITION", 3, {}};
  for (const Vec3f& p : {Vec3f(0, 0, -1), Vec3f(1, 0, -1), Vec3f(0, 1, -1), Vec3f(1, 0, -1), Vec3f(1, 1, -1), Vec3f(0, 1, -1)})
    source.values.insert(source.values.end(), {p.x, p.y, p.z});
  scene.meshes[0].primitives[0].attributes.push_back(source);
  return scene;
}

TEST(Inspect, SeesATornPositionThroughItsSource) {
  EXPECT_EQ(inspect(warped_pair(0)).cracks->torn_positions, 0u);
  const InspectReport torn = inspect(warped_pair(0.01f));
  EXPECT_EQ(torn.cracks->torn_positions, 1u);
  EXPECT_NEAR(torn.cracks->max_gap_px, 20.48, 1e-4); // 0.01 of 4096 / 2 pixels per unit
}

} // namespace
} // namespace domewarp
