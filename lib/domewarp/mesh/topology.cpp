// SPDX-License-Identifier: Apache-2.0
#include "domewarp/mesh/topology.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Utils/PropertyManager.hh>

namespace domewarp {

namespace {

struct Traits : OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::None);
  FaceAttributes(OpenMesh::Attributes::None);
  EdgeAttributes(OpenMesh::Attributes::None);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
};
using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<Traits>;

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// The half-edge structure together with the point that each of its vertices stands for.
struct Connectivity {
  HalfEdges mesh;
  std::vector<std::uint32_t> point_of; ///< per vertex
};

/// OpenMesh refuses complex edges, complex vertices and duplicates, and says so on stderr: such a face gets vertices
/// of its own and stays attached by its edge records.
Connectivity connect(std::uint32_t point_count, std::span<const Triangle> triangles) {
  Connectivity result;
  HalfEdges& mesh = result.mesh;
  mesh.reserve(point_count, point_count + triangles.size(), triangles.size());
  for (std::uint32_t i = 0; i < point_count; ++i) mesh.new_vertex();
  result.point_of.resize(point_count);
  for (std::uint32_t i = 0; i < point_count; ++i) result.point_of[i] = i;
  omerr().disable();
  for (const Triangle& t : triangles) {
    const auto vertex = [](std::uint32_t id) { return HalfEdges::VertexHandle(static_cast<int>(id)); };
    if (mesh.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2])).is_valid()) continue;
    std::array<HalfEdges::VertexHandle, 3> own;
    for (int i = 0; i < 3; ++i) {
      own[i] = mesh.new_vertex();
      result.point_of.push_back(t[i]);
    }
    mesh.add_face(own[0], own[1], own[2]);
  }
  omerr().enable();
  return result;
}

struct Key {
  std::uint32_t a, b, edge;
  auto operator<=>(const Key&) const = default;
};

/// Half-edge edges between the same two points become one record; only boundary edges can have such a twin.
std::vector<std::uint32_t> join_edges(const Connectivity& connectivity, MeshTopology& topology) {
  const HalfEdges& mesh = connectivity.mesh;
  std::vector<std::uint32_t> record_of(mesh.n_edges(), none);
  std::vector<Key> boundary;
  for (std::uint32_t e = 0; e < mesh.n_edges(); ++e) {
    const auto halfedge = mesh.halfedge_handle(HalfEdges::EdgeHandle(static_cast<int>(e)), 0);
    const std::uint32_t p = connectivity.point_of[mesh.from_vertex_handle(halfedge).idx()];
    const std::uint32_t q = connectivity.point_of[mesh.to_vertex_handle(halfedge).idx()];
    const auto [a, b] = std::minmax(p, q);
    if (mesh.is_boundary(HalfEdges::EdgeHandle(static_cast<int>(e)))) {
      boundary.push_back({a, b, e});
      continue;
    }
    record_of[e] = static_cast<std::uint32_t>(topology.edges.size());
    topology.edges.push_back({a, b, 0});
  }
  // A regular edge may have a twin too: the third face of a non-manifold edge.
  std::vector<Key> regular;
  if (!boundary.empty())
    for (std::uint32_t r = 0; r < topology.edges.size(); ++r) regular.push_back({topology.edges[r].a, topology.edges[r].b, r});
  std::sort(regular.begin(), regular.end());
  std::sort(boundary.begin(), boundary.end());
  auto other = regular.begin();
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    const Key& key = boundary[i];
    while (other != regular.end() && std::pair(other->a, other->b) < std::pair(key.a, key.b)) ++other;
    if (i > 0 && boundary[i - 1].a == key.a && boundary[i - 1].b == key.b) {
      record_of[key.edge] = record_of[boundary[i - 1].edge];
    } else if (other != regular.end() && other->a == key.a && other->b == key.b) {
      record_of[key.edge] = other->edge;
    } else {
      record_of[key.edge] = static_cast<std::uint32_t>(topology.edges.size());
      topology.edges.push_back({key.a, key.b, 0});
    }
  }
  return record_of;
}

} // namespace

MeshTopology build_topology(std::uint32_t point_count, std::span<const Triangle> triangles) {
  const Connectivity connectivity = connect(point_count, triangles);
  const HalfEdges& mesh = connectivity.mesh;
  MeshTopology topology;
  const std::vector<std::uint32_t> record_of = join_edges(connectivity, topology);
  topology.edges_of.resize(triangles.size());
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    auto halfedge = mesh.halfedge_handle(HalfEdges::FaceHandle(static_cast<int>(f)));
    for (int turn = 0; turn < 3; ++turn, halfedge = mesh.next_halfedge_handle(halfedge)) {
      const std::uint32_t from = connectivity.point_of[mesh.from_vertex_handle(halfedge).idx()];
      const auto corner = std::find(triangles[f].begin(), triangles[f].end(), from) - triangles[f].begin();
      const std::uint32_t record = record_of[mesh.edge_handle(halfedge).idx()];
      topology.edges_of[f][corner] = record;
      ++topology.edges[record].faces;
    }
  }
  return topology;
}

} // namespace domewarp
