// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/soup.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/t_junctions.h"
#include "domewarp/mesh/weld.h"

namespace domewarp {

namespace {

const Primitive& primitive_of(const Scene& scene, const SoupPart& part) {
  return scene.meshes[scene.instances[part.instance].mesh].primitives[part.primitive];
}

Box box_of(const std::vector<Vec3f>& positions) {
  Vec3f low = positions.front(), high = low;
  for (const Vec3f& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return {Vec3(low), Vec3(high)};
}

/// One box per primitive of each mesh; instances share them.
std::vector<std::vector<Box>> boxes_of(const Scene& scene) {
  std::vector<std::vector<Box>> boxes(scene.meshes.size());
  parallel_each(boxes.size(), 1, [&](std::size_t m) {
    for (const Primitive& primitive : scene.meshes[m].primitives)
      boxes[m].push_back(primitive.positions.empty() ? Box{} : box_of(primitive.positions));
  });
  return boxes;
}

/// Drops the parts that cannot be seen.
void cull_parts(const Scene& scene, const View& view, const ViewCull& cull, Soup& soup) {
  const std::vector<std::vector<Box>> boxes = boxes_of(scene);
  std::erase_if(soup.parts, [&](const SoupPart& part) {
    const Instance& instance = scene.instances[part.instance];
    if (cull.may_be_seen(bounding_ball(boxes[instance.mesh][part.primitive], instance.world, view))) return false;
    soup.outside_view += primitive_of(scene, part).indices.size() / 3;
    return true;
  });
}

std::vector<SoupPart> list_parts(const Scene& scene) {
  std::vector<SoupPart> parts;
  for (int i = 0; i < static_cast<int>(scene.instances.size()); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (int p = 0; p < static_cast<int>(mesh.primitives.size()); ++p) {
      if (mesh.primitives[p].topology != Topology::triangles) continue;
      parts.push_back({i, p, 0});
    }
  }
  return parts;
}

/// Numbers the wedges part by part. Returns how many there are.
std::size_t number_wedges(const Scene& scene, std::vector<SoupPart>& parts) {
  std::size_t wedges = 0;
  for (SoupPart& part : parts) {
    part.first_wedge = static_cast<std::uint32_t>(wedges);
    wedges += primitive_of(scene, part).positions.size();
  }
  return wedges;
}

RawVector<Vec3> eye_positions(const Scene& scene, const View& view, const std::vector<SoupPart>& parts, std::size_t wedges) {
  RawVector<Vec3> positions(wedges);
  parallel_each(parts.size(), 1, [&](std::size_t i) {
    const Primitive& primitive = primitive_of(scene, parts[i]);
    const Mat4& world = scene.instances[parts[i].instance].world;
    parallel_each(primitive.positions.size(), 4096, [&](std::size_t v) {
      positions[parts[i].first_wedge + v] = to_eye(view, to_world(world, primitive.positions[v]));
    });
  });
  return positions;
}

bool is_degenerate(const SoupFace& face) {
  return face.point[0] == face.point[1] || face.point[1] == face.point[2] || face.point[2] == face.point[0];
}

/// Drops the faces that is_dropped(face) names. @return how many
template <typename Predicate>
std::size_t drop_faces(Soup& soup, Predicate&& is_dropped) {
  RawVector<std::uint8_t> dropped(soup.faces.size());
  std::atomic<std::size_t> count = 0;
  parallel_ranges(dropped.size(), 4096, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    for (std::size_t f = begin; f < end; ++f) here += dropped[f] = is_dropped(soup.faces[f]);
    count += here;
  });
  if (count == 0) return 0;
  std::size_t next = 0;
  for (std::size_t f = 0; f < dropped.size(); ++f)
    if (!dropped[f]) soup.faces[next++] = soup.faces[f];
  soup.faces.resize(next);
  return count;
}

void add_faces(const Scene& scene, Soup& soup) {
  std::vector<std::size_t> first(soup.parts.size() + 1, 0);
  for (std::size_t p = 0; p < soup.parts.size(); ++p) first[p + 1] = first[p] + primitive_of(scene, soup.parts[p]).indices.size() / 3;
  soup.faces.resize(first.back());
  parallel_each(soup.parts.size(), 1, [&](std::size_t p) {
    const Primitive& primitive = primitive_of(scene, soup.parts[p]);
    parallel_each(first[p + 1] - first[p], 4096, [&](std::size_t f) {
      SoupFace& face = soup.faces[first[p] + f];
      for (int k = 0; k < 3; ++k) {
        face.wedge[k] = soup.parts[p].first_wedge + primitive.indices[3 * f + k];
        face.point[k] = soup.wedge_point[face.wedge[k]];
      }
      face.part = static_cast<std::uint32_t>(p);
    });
  });
  soup.source_triangles = soup.outside_view + soup.faces.size();
  soup.degenerate_triangles = drop_faces(soup, is_degenerate);
}

/// Only the open edges.
MeshTopology topology_of(const Soup& soup) {
  RawVector<Triangle> triangles(soup.faces.size());
  parallel_each(triangles.size(), 4096, [&](std::size_t f) { triangles[f] = soup.faces[f].point; });
  return {find_open_edges(static_cast<std::uint32_t>(soup.points.size()), triangles), {}};
}

/// Splits faces at the points that lie inside their open edges, one point at a time, until none is left.
class TJunctionSplitter {
public:
  /// @param open the open edges
  TJunctionSplitter(Soup& soup, const MeshTopology& open) : soup_(soup), open_(open), junctions_(find_t_junctions(soup.points, open)) {}

  /// @return whether there were any
  bool run() {
    soup_.t_junctions += junctions_.size();
    if (junctions_.empty()) return false;
    std::vector<std::uint8_t> is_end(soup_.points.size(), 0);
    for (const TJunction& junction : junctions_) is_end[open_.edges[junction.edge].a] = is_end[open_.edges[junction.edge].b] = 1;
    RawVector<SoupFace> done;
    done.reserve(soup_.faces.size() + 2 * junctions_.size());
    for (const SoupFace& face : soup_.faces) split(face, is_end, done);
    soup_.faces = std::move(done);
    return true;
  }

private:
  void split(const SoupFace& face, const std::vector<std::uint8_t>& is_end, RawVector<SoupFace>& done) {
    std::array<std::vector<std::uint32_t>, 3> on; // points to insert on each side, in the face's direction
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = face.point[k], to = face.point[(k + 1) % 3];
      const MeshTopology::Edge* edge = is_end[from] && is_end[to] ? find_edge(open_.edges, from, to) : nullptr;
      if (edge == nullptr) continue;
      const auto range = std::equal_range(junctions_.begin(), junctions_.end(), TJunction{static_cast<std::uint32_t>(edge - open_.edges.data()), 0, 0},
                                          [](const TJunction& x, const TJunction& y) { return x.edge < y.edge; });
      for (auto it = range.first; it != range.second; ++it)
        if (std::find(face.point.begin(), face.point.end(), it->point) == face.point.end()) on[k].push_back(it->point);
      if (edge->a != from) std::reverse(on[k].begin(), on[k].end());
    }
    cut(face, on, done);
  }

  // Cuts at the middle point of one side, towards the corner opposite; the cut has no points of its own.
  void cut(const SoupFace& face, const std::array<std::vector<std::uint32_t>, 3>& on, RawVector<SoupFace>& done) {
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
  const MeshTopology& open_;
  std::vector<TJunction> junctions_;
};

bool is_seen_from_behind(const Soup& soup, const SoupFace& face) {
  const Vec3 a = soup.points[face.point[0]], b = soup.points[face.point[1]], c = soup.points[face.point[2]];
  const Vec3 normal = glm::cross(b - a, c - a);
  // Faces within rounding of edge-on stay: they cover nothing, but dropping one could open its neighbour's edge.
  return glm::dot(normal, a) > 1e-12 * glm::length(normal) * glm::length(a);
}

void drop_back_faces(const Scene& scene, Soup& soup) {
  soup.back_faces = drop_faces(soup, [&](const SoupFace& face) {
    const int material = primitive_of(scene, soup.parts[face.part]).material;
    const bool double_sided = material >= 0 && scene.materials[material].double_sided;
    return !double_sided && is_seen_from_behind(soup, face);
  });
}

double largest(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

} // namespace

Soup make_soup(const Scene& scene, const View& view, const SoupOptions& options) {
  Soup soup;
  soup.parts = list_parts(scene);
  if (options.view_cull != nullptr) cull_parts(scene, view, *options.view_cull, soup);
  Weld welded = weld(eye_positions(scene, view, soup.parts, number_wedges(scene, soup.parts)));
  if (options.weld > 0) soup.snapped = snap(welded, options.weld);
  soup.points = std::move(welded.points);
  soup.wedge_point = std::move(welded.point_of);
  add_faces(scene, soup);
  const MeshTopology open = topology_of(soup);
  soup.near_misses = count_near_misses(soup.points, open, largest(view.eye));
  soup.open_edges = (TJunctionSplitter(soup, open).run() ? topology_of(soup) : open).edges.size();
  if (!options.cull_back_faces) return soup;
  drop_back_faces(scene, soup);
  // Sides whose other face is gone are open now, too: solids that abut part there.
  if (soup.back_faces > 0) {
    const MeshTopology drawn = topology_of(soup);
    TJunctionSplitter(soup, drawn).run();
  }
  return soup;
}

Soup make_loose_soup(const Scene& scene, const View& view) {
  Soup soup;
  soup.parts = list_parts(scene);
  const RawVector<Vec3> positions = eye_positions(scene, view, soup.parts, number_wedges(scene, soup.parts));
  soup.points.assign(positions.begin(), positions.end());
  soup.wedge_point.resize(soup.points.size());
  std::iota(soup.wedge_point.begin(), soup.wedge_point.end(), 0u);
  add_faces(scene, soup);
  return soup;
}

} // namespace domewarp
