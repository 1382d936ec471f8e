// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <map>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/weld.h"
#include "domewarp/refine/level_state.h"
#include "domewarp/refine/small_faces.h"

namespace domewarp {

namespace {

/// Counts the faces of the soup that are not refined on the edges of those that are.
void count_others(const Soup& soup, const SiftedFaces& sifted, const MeshTopology& topology, std::vector<SourceEdge>& counts) {
  std::vector<std::uint8_t> is_end(soup.points.size(), 0);
  for (const std::uint32_t f : sifted.refine)
    for (const std::uint32_t point : points_of(soup, soup.faces[f])) is_end[point] = 1;
  parallel_each(soup.faces.size(), level_block, [&](std::size_t f) {
    if (sifted.fate[f] == FaceFate::refine) return;
    const Triangle point = points_of(soup, soup.faces[f]);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t p = point[k], q = point[(k + 1) % 3];
      const MeshTopology::Edge* edge = is_end[p] && is_end[q] ? find_edge(topology.edges, p, q) : nullptr;
      if (edge == nullptr) continue;
      SourceEdge& count = counts[static_cast<std::size_t>(edge - topology.edges.data())];
      std::atomic_ref(count.faces).fetch_add(1, std::memory_order_relaxed);
      if (sifted.fate[f] == FaceFate::whole) std::atomic_ref(count.whole).fetch_add(1, std::memory_order_relaxed);
    }
  });
}

void add_source_edges(LevelState& state, const SiftedFaces& sifted) {
  const Soup& soup = state.soup;
  RefinedMesh& mesh = state.mesh;
  const std::size_t count = sifted.refine.size();
  RawVector<Triangle> triangles(count);
  parallel_each(count, level_block, [&](std::size_t i) { triangles[i] = points_of(soup, soup.faces[sifted.refine[i]]); });
  const MeshTopology topology = build_topology(static_cast<std::uint32_t>(soup.points.size()), triangles);
  mesh.edges.resize(topology.edges.size());
  mesh.source_edges.resize(topology.edges.size());
  parallel_each(topology.edges.size(), level_block, [&](std::size_t e) {
    const MeshTopology::Edge& edge = topology.edges[e];
    mesh.edges[e] = edge_of(mesh.points, edge.a, edge.b, static_cast<std::uint32_t>(e));
    mesh.source_edges[e].faces = edge.faces;
  });
  if (count < soup.faces.size()) count_others(soup, sifted, topology, mesh.source_edges);
  state.active.resize(count);
  parallel_each(count, level_block, [&](std::size_t i) {
    const SoupFace& face = soup.faces[sifted.refine[i]];
    state.active[i] = {triangles[i], face.wedge, topology.edges_of[i], sifted.refine[i]};
  });
}

} // namespace

RefinedEdge edge_of(std::span<const MappedPoint> points, std::uint32_t p, std::uint32_t q, std::uint32_t source, bool inner) {
  RefinedEdge edge;
  const bool in_order = precedes(points[p].eye, points[q].eye);
  edge.a = in_order ? p : q;
  edge.b = in_order ? q : p;
  edge.source = source;
  edge.inner = inner;
  return edge;
}

std::optional<InnerPlane> inner_plane(const LevelState& state, std::uint32_t face) {
  const Triangle point = points_of(state.soup, state.soup.faces[face]);
  return state.oracle.inner_plane(state.soup.points[point[0]], state.soup.points[point[1]], state.soup.points[point[2]],
                                  !state.plain_faces.empty() && state.plain_faces[face] != 0);
}

LevelState start_levels(const Soup& soup, const EdgeOracle& oracle, const LevelOptions& options) {
  LevelState state{soup, oracle, options.cull, options.plain_faces};
  RefinedMesh& mesh = state.mesh;
  mesh.points.reserve(soup.points.size() + soup.points.size() / 8 + 1024); // a few more must not move them all
  mesh.points.resize(soup.points.size());
  mesh.source_points = soup.points.size();
  parallel_each(soup.points.size(), level_block, [&](std::size_t i) { mesh.points[i] = oracle.locate(soup.points[i]); });
  mesh.evaluations = soup.points.size();
  state.first_wedge = static_cast<std::uint32_t>(soup.wedge_point.size());
  SiftedFaces sifted = sift_faces(soup, mesh.points, oracle, options);
  if (!sifted.refine.empty()) add_source_edges(state, sifted);
  mesh.whole = std::move(sifted.whole);
  mesh.whole_depth_error = sifted.depth_error;
  mesh.clipped = sifted.clipped;
  mesh.off_picture = sifted.off_picture;
  return state;
}

namespace {

using Ends = std::array<std::uint32_t, 2>;

Ends ends_of(std::uint32_t p, std::uint32_t q) { return {std::min(p, q), std::max(p, q)}; }

/// Takes the faces that have one of the sides out of the list.
std::vector<WholeFace> take_faces(const Soup& soup, const std::map<Ends, std::uint32_t>& sides, std::vector<WholeFace>& whole) {
  const auto is_touched = [&](const WholeFace& face) {
    const Triangle point = points_of(soup, soup.faces[face.source]);
    for (int k = 0; k < 3; ++k)
      if (sides.contains(ends_of(point[k], point[(k + 1) % 3]))) return true;
    return false;
  };
  const auto touched = std::stable_partition(whole.begin(), whole.end(), [&](const WholeFace& face) { return !is_touched(face); });
  std::vector<WholeFace> taken(touched, whole.end());
  whole.erase(touched, whole.end());
  return taken;
}

} // namespace

// Rare: a thin face that appears turned over beside one that is drawn as it is.
void wake_whole_faces(LevelState& state, const std::vector<std::uint32_t>& sides) {
  RefinedMesh& mesh = state.mesh;
  const Soup& soup = state.soup;
  std::map<Ends, std::uint32_t> wanted, known;
  for (const std::uint32_t e : sides)
    if (is_whole_source_edge(mesh, mesh.edges[e]) && mesh.source_edges[mesh.edges[e].source].whole > 0) wanted[ends_of(mesh.edges[e].a, mesh.edges[e].b)] = e;
  if (wanted.empty()) return;
  const std::vector<WholeFace> woken = take_faces(soup, wanted, mesh.whole);
  for (std::uint32_t e = 0; e < mesh.edges.size(); ++e)
    if (is_whole_source_edge(mesh, mesh.edges[e])) known[ends_of(mesh.edges[e].a, mesh.edges[e].b)] = e;
  for (const WholeFace& face : woken) {
    const SoupFace& source = soup.faces[face.source];
    const Triangle point = points_of(soup, source);
    RefinedFace& added = mesh.faces.emplace_back(RefinedFace{point, source.wedge, {}, face.source});
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t p = point[k], q = point[(k + 1) % 3];
      const auto [edge, is_new] = known.try_emplace(ends_of(p, q), static_cast<std::uint32_t>(mesh.edges.size()));
      added.edge[k] = edge->second;
      if (!is_new) continue;
      RefinedEdge record = edge_of(mesh.points, p, q, static_cast<std::uint32_t>(mesh.source_edges.size()));
      record.error = record.arch = face.error;
      record.depth_error = mesh.whole_depth_error;
      mesh.edges.push_back(record);
      mesh.source_edges.emplace_back();
    }
  }
  for (SourceEdge& edge : mesh.source_edges) edge.whole = 0;
  for (const WholeFace& face : mesh.whole) {
    const Triangle point = points_of(soup, soup.faces[face.source]);
    for (int k = 0; k < 3; ++k)
      if (const auto edge = known.find(ends_of(point[k], point[(k + 1) % 3])); edge != known.end()) ++mesh.source_edges[mesh.edges[edge->second].source].whole;
  }
  for (SourceEdge& edge : mesh.source_edges) edge.faces = std::max(edge.faces, edge.whole + 1);
}

} // namespace domewarp
