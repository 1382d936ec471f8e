// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/soup.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/t_junctions.h"
#include "domewarp/mesh/weld.h"

namespace domewarp {

namespace {

const Primitive& primitive_of(const Scene& scene, const Part& part) {
  return scene.meshes[scene.instances[part.instance].mesh].primitives[part.primitive];
}

std::vector<Part> list_parts(const Scene& scene, std::size_t& wedges) {
  std::vector<Part> parts;
  wedges = 0;
  for (int i = 0; i < static_cast<int>(scene.instances.size()); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (int p = 0; p < static_cast<int>(mesh.primitives.size()); ++p) {
      if (mesh.primitives[p].topology != Topology::triangles) continue;
      parts.push_back({i, p, static_cast<std::uint32_t>(wedges)});
      wedges += mesh.primitives[p].positions.size();
    }
  }
  return parts;
}

std::vector<Vec3> eye_positions(const Scene& scene, const View& view, const std::vector<Part>& parts, std::size_t wedges) {
  std::vector<Vec3> positions(wedges);
  parallel_each(parts.size(), 1, [&](std::size_t i) {
    const Primitive& primitive = primitive_of(scene, parts[i]);
    const Mat4& world = scene.instances[parts[i].instance].world;
    parallel_each(primitive.positions.size(), 4096, [&](std::size_t v) {
      positions[parts[i].first_wedge + v] = to_eye(view, to_world(world, primitive.positions[v]));
    });
  });
  return positions;
}

void add_faces(const Scene& scene, Soup& soup) {
  for (std::uint32_t p = 0; p < soup.parts.size(); ++p) {
    const Primitive& primitive = primitive_of(scene, soup.parts[p]);
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      SoupFace face;
      for (int k = 0; k < 3; ++k) {
        face.wedge[k] = soup.parts[p].first_wedge + primitive.indices[i + k];
        face.point[k] = soup.wedge_point[face.wedge[k]];
      }
      face.part = p;
      ++soup.source_triangles;
      if (face.point[0] == face.point[1] || face.point[1] == face.point[2] || face.point[2] == face.point[0])
        ++soup.degenerate_triangles;
      else
        soup.faces.push_back(face);
    }
  }
}

MeshTopology topology_of(const Soup& soup) {
  std::vector<Triangle> triangles(soup.faces.size());
  for (std::size_t f = 0; f < triangles.size(); ++f) triangles[f] = soup.faces[f].point;
  return build_topology(static_cast<std::uint32_t>(soup.points.size()), triangles);
}

/// Splits faces at the points that lie inside their open edges, one point at a time, until none is left.
class TJunctionSplitter {
public:
  explicit TJunctionSplitter(Soup& soup) : soup_(soup), junctions_(find_t_junctions(soup.points, soup.topology)) {}

  void run() {
    soup_.t_junctions = junctions_.size();
    if (junctions_.empty()) return;
    std::vector<SoupFace> done;
    for (std::size_t f = 0; f < soup_.faces.size(); ++f) split(soup_.faces[f], soup_.topology.edges_of[f], done);
    soup_.faces = std::move(done);
    soup_.topology = topology_of(soup_);
  }

private:
  void split(const SoupFace& face, const std::array<std::uint32_t, 3>& edges, std::vector<SoupFace>& done) {
    std::array<std::vector<std::uint32_t>, 3> on; // points to insert on each side, in the face's direction
    for (int k = 0; k < 3; ++k) {
      const auto range = std::equal_range(junctions_.begin(), junctions_.end(), TJunction{edges[k], 0, 0},
                                          [](const TJunction& x, const TJunction& y) { return x.edge < y.edge; });
      for (auto it = range.first; it != range.second; ++it)
        if (std::find(face.point.begin(), face.point.end(), it->point) == face.point.end()) on[k].push_back(it->point);
      if (soup_.topology.edges[edges[k]].a != face.point[k]) std::reverse(on[k].begin(), on[k].end());
    }
    cut(face, on, done);
  }

  // Cuts at the middle point of one side, towards the corner opposite; the cut has no points of its own.
  void cut(const SoupFace& face, const std::array<std::vector<std::uint32_t>, 3>& on, std::vector<SoupFace>& done) {
    const auto side = std::find_if(on.begin(), on.end(), [](const auto& points) { return !points.empty(); });
    if (side == on.end()) {
      done.push_back(face);
      return;
    }
    const int k = static_cast<int>(side - on.begin()), next = (k + 1) % 3, last = (k + 2) % 3;
    const auto middle = side->begin() + static_cast<std::ptrdiff_t>(side->size() / 2);
    const std::uint32_t wedge = add_wedge(face, k, *middle);
    SoupFace left = face, right = face;
    left.point[next] = right.point[k] = *middle;
    left.wedge[next] = right.wedge[k] = wedge;
    std::array<std::vector<std::uint32_t>, 3> on_left, on_right;
    on_left[k].assign(side->begin(), middle);
    on_left[last] = on[last];
    on_right[k].assign(middle + 1, side->end());
    on_right[next] = on[next];
    cut(left, on_left, done);
    cut(right, on_right, done);
  }

  std::uint32_t add_wedge(const SoupFace& face, int k, std::uint32_t point) {
    const Vec3 a = soup_.points[face.point[k]], d = soup_.points[face.point[(k + 1) % 3]] - a;
    const double t = glm::dot(soup_.points[point] - a, d) / glm::dot(d, d);
    soup_.extra_wedges.push_back({{face.wedge[k], face.wedge[(k + 1) % 3], face.wedge[k]}, {1 - t, t, 0}, point, face.part});
    return static_cast<std::uint32_t>(soup_.wedge_point.size() + soup_.extra_wedges.size() - 1);
  }

  Soup& soup_;
  std::vector<TJunction> junctions_;
};

bool is_seen_from_behind(const Soup& soup, const SoupFace& face) {
  const Vec3 a = soup.points[face.point[0]], b = soup.points[face.point[1]], c = soup.points[face.point[2]];
  const Vec3 normal = glm::cross(b - a, c - a);
  // Faces within rounding of edge-on stay: they cover nothing, but dropping one could open its neighbour's edge.
  return glm::dot(normal, a) > 1e-12 * glm::length(normal) * glm::length(a);
}

void drop_back_faces(const Scene& scene, Soup& soup) {
  std::vector<std::uint32_t> kept(soup.topology.edges.size(), 0);
  std::vector<SoupFace> front;
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    const int material = primitive_of(scene, soup.parts[soup.faces[f].part]).material;
    const bool double_sided = material >= 0 && scene.materials[material].double_sided;
    if (!double_sided && is_seen_from_behind(soup, soup.faces[f])) continue;
    for (const std::uint32_t edge : soup.topology.edges_of[f]) ++kept[edge];
    front.push_back(soup.faces[f]);
  }
  soup.back_faces = soup.faces.size() - front.size();
  if (soup.back_faces == 0) return;
  for (std::size_t e = 0; e < kept.size(); ++e) soup.edges_opened_by_culling += kept[e] == 1 && soup.topology.edges[e].faces > 1;
  soup.faces = std::move(front);
  soup.topology = topology_of(soup);
}

} // namespace

Soup make_soup(const Scene& scene, const View& view, const SoupOptions& options) {
  Soup soup;
  std::size_t wedges = 0;
  soup.parts = list_parts(scene, wedges);
  Weld welded = weld(eye_positions(scene, view, soup.parts, wedges));
  soup.points = std::move(welded.points);
  soup.wedge_point = std::move(welded.point_of);
  add_faces(scene, soup);
  soup.topology = topology_of(soup);
  TJunctionSplitter(soup).run();
  for (const MeshTopology::Edge& edge : soup.topology.edges) soup.open_edges += edge.faces == 1;
  if (options.cull_back_faces) drop_back_faces(scene, soup);
  return soup;
}

} // namespace domewarp
