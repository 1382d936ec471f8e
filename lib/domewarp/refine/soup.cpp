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

bool is_degenerate(const Soup& soup, const SoupFace& face) {
  const Triangle point = points_of(soup, face);
  return point[0] == point[1] || point[1] == point[2] || point[2] == point[0];
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
  const auto face_at = [&](const std::uint8_t* flag) { return soup.faces.begin() + (flag - dropped.data()); };
  const std::uint8_t* const end = dropped.data() + dropped.size();
  const std::uint8_t* run = std::find(dropped.data(), const_cast<std::uint8_t*>(end), 1);
  auto next = face_at(run);
  while (run != end) { // a run of kept faces at a time
    const std::uint8_t* const kept = std::find(run, end, 0);
    run = std::find(kept, end, 1);
    next = std::move(face_at(kept), face_at(run), next);
  }
  soup.faces.erase(next, soup.faces.end());
  return count;
}

void add_faces(const Scene& scene, Soup& soup) {
  std::vector<std::size_t> first(soup.parts.size() + 1, 0);
  for (std::size_t p = 0; p < soup.parts.size(); ++p) first[p + 1] = first[p] + primitive_of(scene, soup.parts[p]).indices.size() / 3;
  soup.faces.reserve(first.back() + first.back() / 64 + 64); // splitting a few must not move them all
  soup.faces.resize(first.back());
  parallel_each(soup.parts.size(), 1, [&](std::size_t p) {
    const Primitive& primitive = primitive_of(scene, soup.parts[p]);
    parallel_each(first[p + 1] - first[p], 4096, [&](std::size_t f) {
      SoupFace& face = soup.faces[first[p] + f];
      for (int k = 0; k < 3; ++k) face.wedge[k] = soup.parts[p].first_wedge + primitive.indices[3 * f + k];
      face.part = static_cast<std::uint32_t>(p);
    });
  });
  soup.source_triangles = soup.outside_view + soup.faces.size();
  soup.degenerate_triangles = drop_faces(soup, [&](const SoupFace& face) { return is_degenerate(soup, face); });
}

/// Only the open edges.
MeshTopology topology_of(const Soup& soup) {
  const auto triangle = [&](std::size_t f) { return points_of(soup, soup.faces[f]); };
  return {find_open_edges(static_cast<std::uint32_t>(soup.points.size()), soup.faces.size(), triangle), {}};
}

/// Replaces faces, from the last to the first, so that none moves twice. @param faces ascending
/// @param pieces of all of them, in order; @param ends of the pieces of each
void replace_faces(RawVector<SoupFace>& all, std::span<const std::uint32_t> faces, std::span<const SoupFace> pieces, std::span<const std::size_t> ends) {
  std::size_t old_end = all.size(), end = all.size() + pieces.size() - faces.size();
  all.resize(end);
  for (std::size_t i = faces.size(); i-- > 0;) {
    const std::size_t after = faces[i] + std::size_t(1), begin = i == 0 ? 0 : ends[i - 1];
    std::move_backward(all.begin() + after, all.begin() + old_end, all.begin() + end);
    end -= old_end - after;
    std::copy(pieces.begin() + begin, pieces.begin() + ends[i], all.begin() + (end -= ends[i] - begin));
    old_end = faces[i];
  }
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
    const std::vector<std::uint32_t> touched = touched_faces();
    RawVector<SoupFace> pieces;
    std::vector<std::size_t> ends;
    for (const std::uint32_t face : touched) {
      split(soup_.faces[face], pieces);
      ends.push_back(pieces.size());
    }
    replace_faces(soup_.faces, touched, pieces, ends);
    return true;
  }

private:
  /// Those with a side whose ends are ends of edges to be split, ascending.
  std::vector<std::uint32_t> touched_faces() const {
    constexpr std::size_t block_size = 16384;
    std::vector<std::uint8_t> is_end(soup_.points.size(), 0);
    for (const TJunction& junction : junctions_) is_end[open_.edges[junction.edge].a] = is_end[open_.edges[junction.edge].b] = 1;
    std::vector<std::vector<std::uint32_t>> blocks((soup_.faces.size() + block_size - 1) / block_size);
    parallel_each(blocks.size(), 1, [&](std::size_t block) {
      for (std::size_t f = block * block_size; f < std::min(soup_.faces.size(), (block + 1) * block_size); ++f) {
        const Triangle point = points_of(soup_, soup_.faces[f]);
        if (is_end[point[0]] + is_end[point[1]] + is_end[point[2]] >= 2) blocks[block].push_back(static_cast<std::uint32_t>(f));
      }
    });
    std::vector<std::uint32_t> touched;
    for (const auto& block : blocks) touched.insert(touched.end(), block.begin(), block.end());
    return touched;
  }

  void split(const SoupFace& face, RawVector<SoupFace>& done) {
    std::array<std::vector<std::uint32_t>, 3> on; // points to insert on each side, in the face's direction
    const Triangle point = points_of(soup_, face);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = point[k], to = point[(k + 1) % 3];
      const MeshTopology::Edge* edge = find_edge(open_.edges, from, to);
      if (edge == nullptr) continue;
      const auto range = std::equal_range(junctions_.begin(), junctions_.end(), TJunction{static_cast<std::uint32_t>(edge - open_.edges.data()), 0, 0},
                                          [](const TJunction& x, const TJunction& y) { return x.edge < y.edge; });
      for (auto it = range.first; it != range.second; ++it)
        if (std::find(point.begin(), point.end(), it->point) == point.end()) on[k].push_back(it->point);
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
    const Triangle corner = points_of(soup_, face);
    const Vec3 a = soup_.points[corner[k]], d = soup_.points[corner[(k + 1) % 3]] - a;
    const double t = glm::dot(soup_.points[point] - a, d) / glm::dot(d, d);
    soup_.extra_wedges.push_back({{face.wedge[k], face.wedge[(k + 1) % 3], face.wedge[k]}, {1 - t, t, 0}, point, face.part});
    soup_.wedge_point.push_back(point);
    return static_cast<std::uint32_t>(soup_.wedge_point.size() - 1);
  }

  Soup& soup_;
  const MeshTopology& open_;
  std::vector<TJunction> junctions_;
};

bool is_seen_from_behind(const Soup& soup, const SoupFace& face) {
  const Triangle point = points_of(soup, face);
  const Vec3 a = soup.points[point[0]], b = soup.points[point[1]], c = soup.points[point[2]];
  const Vec3 normal = glm::cross(b - a, c - a);
  // Faces within rounding of edge-on stay: they cover nothing, but dropping one could open its neighbour's edge.
  const double away = glm::dot(normal, a);
  return away > 0 && away > 1e-12 * glm::length(normal) * glm::length(a);
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
  soup.source_wedges = soup.wedge_point.size();
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
  soup.source_wedges = soup.wedge_point.size();
  add_faces(scene, soup);
  return soup;
}

} // namespace domewarp
