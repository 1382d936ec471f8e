// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/half_edges.h"
#include "domewarp/mesh/point_tree.h"
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

/// Positions with many equal ones, far apart in the input.
std::vector<Vec3> repeated_positions(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> coordinate(-40, 40);
  std::vector<Vec3> positions;
  for (std::size_t i = 0; i < count; ++i) positions.emplace_back(coordinate(random), coordinate(random), 0.1 * coordinate(random));
  return positions;
}

TEST(Weld, AgreesWithAMapForAnyNumberOfThreads) {
  const std::uint32_t seed = 20011;
  const std::vector<Vec3> positions = repeated_positions(300'000, seed);
  std::map<std::array<double, 3>, std::uint32_t> ids;
  std::vector<std::uint32_t> expected;
  for (const Vec3& p : positions)
    expected.push_back(ids.try_emplace({p.x + 0.0, p.y + 0.0, p.z + 0.0}, static_cast<std::uint32_t>(ids.size())).first->second);
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const Weld welded = weld(positions);
    EXPECT_EQ(welded.point_of, expected) << threads << " threads, seed " << seed;
    EXPECT_EQ(welded.points.size(), ids.size());
  }
}

TEST(Weld, SnapJoinsChainsOfNearPointsAtTheOneThatPrecedes) {
  // A corner modelled three times, each 0.6 mm beside the last, and one 2 mm away.
  const std::vector<Vec3> positions = {{0.0006, 0, 0}, {0.0012, 0, 0}, {0, 0, 0}, {0.0032, 0, 0}};
  for (const std::vector<std::size_t>& order : {std::vector<std::size_t>{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 3, 0, 2}}) {
    std::vector<Vec3> shuffled;
    for (const std::size_t i : order) shuffled.push_back(positions[i]);
    Weld welded = weld(shuffled);
    EXPECT_EQ(snap(welded, 0.001), 2u);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(welded.points[welded.point_of[i]], order[i] == 3 ? positions[3] : positions[2]);
  }
}

TEST(Weld, SnapLeavesPointsFartherApartAlone) {
  Weld welded = weld(std::vector<Vec3>{{0, 0, 0}, {0.0011, 0, 0}});
  EXPECT_EQ(snap(welded, 0.001), 0u);
}

TEST(PointTree, FindsWhatBruteForceFinds) {
  const std::uint32_t seed = 7;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const auto draw = [&] { return Vec3(coordinate(random), coordinate(random), coordinate(random)); };
  std::vector<Vec3> points(2000);
  for (Vec3& p : points) p = draw();
  std::vector<std::uint32_t> ids(points.size());
  std::iota(ids.begin(), ids.end(), 0u);
  const PointTree tree(points, ids);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 a = draw(), b = trial % 4 == 0 ? a : trial % 4 == 1 ? Vec3(a.x, a.y, 1) : draw();
    const auto is_near = [&](std::uint32_t id) {
      const Vec3 d = b - a;
      const double t = a == b ? 0 : std::clamp(glm::dot(points[id] - a, d) / glm::dot(d, d), 0.0, 1.0);
      return glm::length(points[id] - (a + t * d)) <= 0.05;
    };
    std::vector<std::uint32_t> found, expected;
    tree.visit_near_segment(a, b, 0.05, [&](std::uint32_t id) {
      if (is_near(id)) found.push_back(id);
      return true;
    });
    std::copy_if(ids.begin(), ids.end(), std::back_inserter(expected), is_near);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << "trial " << trial << ", seed " << seed;
  }
}

TEST(NearMisses, CountsCornersThatTwoMatricesRoundedDifferently) {
  // Two quads that should share an edge; the second's corners came through another matrix and are one float32 unit off.
  const double off = std::nextafter(2.0f, 3.0f) - 2.0f;
  const std::vector<Vec3> points = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2 + off, 0, 0}, {4, 0, 0}, {2 + off, 2, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(count_near_misses(points, build_topology(6, triangles), 0), 2u);
  std::vector<Vec3> apart = points;
  apart[3].x = apart[5].x = 2.001;
  EXPECT_EQ(count_near_misses(apart, build_topology(6, triangles), 0), 0u);
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

TEST(Topology, IsTheSameForAnyNumberOfThreads) {
  const std::uint32_t seed = 5;
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::uint32_t> id(0, 4999);
  std::vector<Triangle> triangles;
  while (triangles.size() < 60'000) {
    const Triangle t{id(random), id(random), id(random)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  }
  const auto build = [&](int threads) {
    const ThreadLimit limit(threads);
    return build_topology(5000, triangles);
  };
  const MeshTopology one = build(1), eight = build(8);
  EXPECT_EQ(one.edges_of, eight.edges_of) << "seed " << seed;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> expected;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++expected[std::minmax({t[k], t[(k + 1) % 3]})];
  ASSERT_EQ(one.edges.size(), expected.size());
  for (const auto& edge : one.edges) EXPECT_EQ(edge.faces, expected.at({edge.a, edge.b}));
}

TEST(Topology, OpenEdgesAreThoseOfOneFace) {
  const std::vector<Triangle> soup = {{0, 1, 2}, {2, 1, 3}, {3, 1, 4}, {0, 1, 4}};
  const MeshTopology all = build_topology(5, soup);
  std::vector<std::array<std::uint32_t, 2>> expected, got;
  for (const MeshTopology::Edge& edge : all.edges)
    if (edge.faces == 1) expected.push_back({edge.a, edge.b});
  const std::vector<MeshTopology::Edge> open = find_open_edges(5, soup.size(), [&](std::size_t f) { return soup[f]; });
  for (const MeshTopology::Edge& edge : open) got.push_back({edge.a, edge.b});
  EXPECT_EQ(got, expected);
  EXPECT_EQ(got.size(), 4u);
  ASSERT_NE(find_edge(open, 2, 0), nullptr);
  EXPECT_EQ(find_edge(open, 2, 0)->b, 2u);
  EXPECT_EQ(find_edge(open, 1, 2), nullptr) << "an inner edge";
}

TEST(Topology, OpenEdgesOfAnyTrianglesAreThoseThatTheWholeTopologyLists) {
  std::mt19937 random(7);
  for (const std::uint32_t points : {5u, 40u, 3000u}) {
    std::uniform_int_distribution<std::uint32_t> draw(0, points - 1);
    std::vector<Triangle> soup;
    while (soup.size() < (points == 40 ? 300u : 40000u)) { // windings as they come: edges of 1, 2, 3, ... faces, passed in any directions
      const Triangle t{draw(random), draw(random), draw(random)};
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      soup.push_back(t);
      if (soup.size() % 3 != 0) soup.push_back({t[2], t[1], draw(random) == t[0] ? t[0] : (std::max(t[1], t[2]) + 1) % points});
      if (soup.back()[2] == soup.back()[0] || soup.back()[2] == soup.back()[1]) soup.pop_back();
    }
    std::vector<std::array<std::uint32_t, 2>> expected, got;
    for (const MeshTopology::Edge& edge : build_topology(points, soup).edges)
      if (edge.faces == 1) expected.push_back({edge.a, edge.b});
    for (const MeshTopology::Edge& edge : find_open_edges(points, soup.size(), [&](std::size_t f) { return soup[f]; })) {
      EXPECT_EQ(edge.faces, 1u);
      got.push_back({edge.a, edge.b});
    }
    EXPECT_EQ(got, expected) << points << " points";
    EXPECT_EQ(expected.empty(), points == 5);
  }
}

TEST(HalfEdges, KnowLoopsAndEulerCharacteristic) {
  const std::vector<Triangle> disc = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  EXPECT_EQ(walk_half_edges(6, disc).boundary_loops, 1u);
  EXPECT_EQ(walk_half_edges(6, disc).euler_characteristic(), 1);
  const std::vector<Triangle> tetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_EQ(walk_half_edges(4, tetrahedron).boundary_loops, 0u);
  EXPECT_EQ(walk_half_edges(4, tetrahedron).euler_characteristic(), 2);
  const std::vector<Triangle> opened = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}};
  EXPECT_EQ(walk_half_edges(4, opened).boundary_loops, 1u);
}

TEST(HalfEdges, DetachAThirdFaceOnAnEdge) {
  EXPECT_EQ(walk_half_edges(5, std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}).detached_faces, 1u);
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
