// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "domewarp/mesh/t_junctions.h"
#include "domewarp/mesh/topology.h"
#include "domewarp/mesh/weld.h"

namespace domewarp {
namespace {

std::vector<std::uint32_t> face_counts(const MeshTopology& topology) {
  std::vector<std::uint32_t> counts;
  for (const auto& edge : topology.edges) counts.push_back(edge.faces);
  std::sort(counts.begin(), counts.end());
  return counts;
}

TEST(Weld, JoinsEqualBitsAndBothZerosAndNothingElse) {
  const std::vector<Vec3> positions = {{0, 1, 2}, {-0.0, 1, 2}, {0, 1, std::nextafter(2.0, 3.0)}, {0, 1, 2}};
  const Weld welded = weld(positions);
  EXPECT_EQ(welded.points.size(), 2u);
  EXPECT_EQ(welded.point_of, (std::vector<std::uint32_t>{0, 0, 1, 0}));
}

TEST(Topology, ThreeTrianglesOnOneEdgeShareItsRecord) {
  const std::vector<Triangle> fan = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const MeshTopology topology = build_topology(5, fan);
  EXPECT_EQ(topology.edges.size(), 7u);
  EXPECT_EQ(face_counts(topology).back(), 3u);
}

TEST(Topology, TwoFacesOfEqualDirectionShareTheirEdge) {
  const std::vector<Triangle> flipped = {{0, 1, 2}, {0, 1, 3}};
  EXPECT_EQ(build_topology(4, flipped).edges.size(), 5u);
}

TEST(Topology, AMoebiusStripHasTheEdgesOfItsTriangles) {
  // Five vertices, five triangles, each on three consecutive vertices: the classic minimal strip.
  std::vector<Triangle> strip;
  for (std::uint32_t i = 0; i < 5; ++i) strip.push_back({i, (i + 1) % 5, (i + 2) % 5});
  const MeshTopology topology = build_topology(5, strip);
  EXPECT_EQ(topology.edges.size(), 10u);
  EXPECT_EQ(face_counts(topology), (std::vector<std::uint32_t>{1, 1, 1, 1, 1, 2, 2, 2, 2, 2}));
}

TEST(Topology, BowTiesDuplicatesAndMirroredFacesAreTaken) {
  const std::vector<Triangle> soup = {{0, 1, 2}, {0, 3, 4}, {0, 5, 6}, {0, 1, 2}, {2, 1, 0}};
  const MeshTopology topology = build_topology(7, soup);
  EXPECT_EQ(topology.edges.size(), 9u);
  EXPECT_EQ(face_counts(topology), (std::vector<std::uint32_t>{1, 1, 1, 1, 1, 1, 3, 3, 3}));
  for (std::size_t f = 0; f < soup.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const auto& edge = topology.edges[topology.edges_of[f][k]];
      EXPECT_EQ(std::minmax(soup[f][k], soup[f][(k + 1) % 3]), std::minmax(edge.a, edge.b));
    }
}

TEST(TJunctions, FindsTheVertexInsideAnOpenEdgeAndOnlyThat) {
  // A quad's long side against two quads' short sides: (1, 0) lies inside the long edge.
  const std::vector<Vec3> points = {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, -1, 0}, {2, -1, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 0, 4}, {1, 3, 5}};
  const MeshTopology topology = build_topology(6, triangles);
  const std::vector<TJunction> found = find_t_junctions(points, topology);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].point, 3u);
  EXPECT_DOUBLE_EQ(found[0].t, 0.5);
}

TEST(TJunctions, LeavesAVertexBesideTheEdgeAlone) {
  const std::vector<Vec3> points = {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -0.001, 0}, {0, -1, 0}, {2, -1, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 0, 4}, {1, 3, 5}};
  EXPECT_TRUE(find_t_junctions(points, build_topology(6, triangles)).empty());
}

} // namespace
} // namespace domewarp
