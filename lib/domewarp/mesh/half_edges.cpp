// SPDX-License-Identifier: Apache-2.0
#include "domewarp/mesh/half_edges.h"

#include <array>
#include <vector>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

namespace domewarp {

namespace {

struct Traits : OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::None);
  FaceAttributes(OpenMesh::Attributes::None);
  EdgeAttributes(OpenMesh::Attributes::None);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
};
using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<Traits>;

/// OpenMesh refuses complex edges, complex vertices and duplicates, and says so on stderr: such a face gets vertices of
/// its own.
std::size_t add_faces(HalfEdges& mesh, std::span<const Triangle> triangles) {
  std::size_t detached = 0;
  omerr().disable();
  for (const Triangle& t : triangles) {
    const auto vertex = [](std::uint32_t id) { return HalfEdges::VertexHandle(static_cast<int>(id)); };
    if (mesh.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2])).is_valid()) continue;
    ++detached;
    mesh.add_face(mesh.new_vertex(), mesh.new_vertex(), mesh.new_vertex());
  }
  omerr().enable();
  return detached;
}

std::size_t count_boundary_loops(const HalfEdges& mesh) {
  std::vector<std::uint8_t> seen(mesh.n_halfedges(), 0);
  std::size_t loops = 0;
  for (const auto start : mesh.halfedges()) {
    if (!mesh.is_boundary(start) || seen[static_cast<std::size_t>(start.idx())]) continue;
    ++loops;
    for (HalfEdges::HalfedgeHandle at = start; !seen[static_cast<std::size_t>(at.idx())]; at = mesh.next_halfedge_handle(at))
      seen[static_cast<std::size_t>(at.idx())] = 1;
  }
  return loops;
}

} // namespace

MeshShape walk_half_edges(std::uint32_t point_count, std::span<const Triangle> triangles) {
  HalfEdges mesh;
  mesh.reserve(point_count, point_count + triangles.size(), triangles.size());
  for (std::uint32_t i = 0; i < point_count; ++i) mesh.new_vertex();
  MeshShape shape;
  shape.detached_faces = add_faces(mesh, triangles);
  for (const auto vertex : mesh.vertices()) shape.vertices += !mesh.is_isolated(vertex);
  shape.edges = mesh.n_edges();
  shape.faces = mesh.n_faces();
  shape.boundary_loops = count_boundary_loops(mesh);
  return shape;
}

} // namespace domewarp
