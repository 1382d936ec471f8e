// SPDX-License-Identifier: Apache-2.0
// Based on: level-synchronous templates over shared edge records (Hatipoglu and Ozturan 2015 for the parallel
// structure, without their propagation: every mark is needed by its own edge).
#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/core/rounding.h"
#include "domewarp/mesh/weld.h"
#include "domewarp/refine/level_state.h"
#include "domewarp/refine/pattern_choice.h"

namespace domewarp {

namespace {

constexpr int first_depth = 2;     ///< a face is judged in 16 parts, and more finely after each insertion
constexpr int most_insertions = 4; ///< faces that their bound never proves good (long slivers beside the eye) would go on for ever
constexpr std::uint32_t local_bit = 0x80000000; ///< marks ids that count from the start of a block's own results

/// A new edge inside a face of the soup: the ids of its ends, its bounds where known.
struct InnerEdge {
  std::uint32_t p, q, source;
  float second = -1, depth = 0; ///< see RefinedEdge::second
};

/// What one block of faces turns into.
struct FaceBlock {
  std::vector<RefinedFace> active, final;
  std::vector<InnerEdge> edges;
  std::vector<MappedPoint> points;                 ///< inserted inside faces
  std::vector<Wedge> wedges;
  std::size_t clipped = 0, off_picture = 0, uncertified = 0;
  FaceJudgement judgement;
};

std::optional<Vec3> weights_inside(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& normal, double area2) {
  const Vec3 weights(glm::dot(normal, glm::cross(c - b, p - b)) / area2, glm::dot(normal, glm::cross(a - c, p - c)) / area2,
                     glm::dot(normal, glm::cross(b - a, p - a)) / area2);
  // A hit within rounding of an edge belongs to the edge, whose extremum has settled it.
  constexpr double margin = 1e-9;
  if (weights.x > margin && weights.y > margin && weights.z > margin) return weights;
  return std::nullopt;
}

/// Splits or finishes the faces of one block.
class FaceSplitter {
public:
  FaceSplitter(const LevelState& state, FaceBlock& block) : state_(state), mesh_(state.mesh), oracle_(state.oracle), block_(block) {}

  void split(const RefinedFace& face, const Triangle& middle_wedges) {
    unsigned marks = 0;
    for (int k = 0; k < 3; ++k) marks |= static_cast<unsigned>(is_split(mesh_, face.edge[k])) << k;
    if (marks == 0 && std::ranges::any_of(face.edge, [&](std::uint32_t e) { return mesh_.edges[e].wanted; })) return block_.active.push_back(face); // it waits as well
    if (marks == 0) return finish(face);
    std::array<std::uint32_t, 6> point, wedge;
    for (int k = 0; k < 3; ++k) {
      point[k] = face.point[k];
      wedge[k] = face.wedge[k];
      point[3 + k] = mesh_.edges[face.edge[k]].middle;
      wedge[3 + k] = middle_wedges[k];
    }
    std::array<const MappedPoint*, 6> mapped{};
    for (std::size_t i = 0; i < 6; ++i) mapped[i] = point[i] == RefinedEdge::none ? nullptr : &mesh_.points[point[i]];
    const auto [pattern, bend] = choose_pattern(marks, mapped, oracle_);
    const std::uint32_t first_edge = static_cast<std::uint32_t>(block_.edges.size());
    for (int i = 0; i < pattern.edges; ++i) {
      InnerEdge edge{point[pattern.edge[i][0]], point[pattern.edge[i][1]], face.source};
      if (bend[i]) {
        edge.second = rounded_up(bend[i]->second);
        edge.depth = rounded_up(bend[i]->depth);
      }
      block_.edges.push_back(edge);
    }
    for (int i = 0; i < pattern.faces; ++i) {
      RefinedFace part;
      part.source = face.source;
      part.insertions = face.insertions;
      for (int k = 0; k < 3; ++k) {
        const int from = pattern.face[i][k], to = pattern.face[i][(k + 1) % 3];
        part.point[k] = point[from];
        part.wedge[k] = wedge[from];
        part.edge[k] = edge_between(face, pattern, from, to, first_edge);
      }
      if (is_off_picture(part))
        ++block_.off_picture;
      else
        block_.active.push_back(part);
    }
  }

private:
  const MappedPoint& corner(const RefinedFace& face, int k) const { return corner_of(mesh_, face, k); }

  /// Its corners must be points of the mesh already.
  bool is_off_picture(const RefinedFace& face) const {
    return state_.cull != nullptr && !state_.cull->may_be_seen(corner(face, 0), corner(face, 1), corner(face, 2));
  }

  std::uint32_t edge_between(const RefinedFace& face, const SplitPattern& pattern, int from, int to, std::uint32_t first_edge) const {
    for (int i = 0; i < pattern.edges; ++i)
      if ((pattern.edge[i][0] == from && pattern.edge[i][1] == to) || (pattern.edge[i][0] == to && pattern.edge[i][1] == from))
        return local_bit | (first_edge + static_cast<std::uint32_t>(i));
    if (from < 3 && to < 3) return face.edge[to == (from + 1) % 3 ? from : to]; // a whole side
    const int corner = std::min(from, to), side = std::max(from, to) - 3;        // half of a side
    const RefinedEdge& edge = mesh_.edges[face.edge[side]];
    return edge.child + (edge.a == face.point[corner] ? 0 : 1);
  }

  /// A face none of whose edges needs a split: drawn, dropped, or given a vertex inside.
  void finish(const RefinedFace& face) {
    if (is_well_inside(face)) {
      if (const std::optional<Vec3> weights = error_vertex(face)) return insert(face, *weights);
      block_.final.push_back(face);
      return;
    }
    const int hidden_by = hiding_boundary(state_, face);
    if (const std::optional<Vec3> weights = inner_vertex(face, hidden_by)) return insert(face, *weights);
    if (hidden_by < 0)
      block_.final.push_back(face);
    else
      ++block_.clipped;
  }

  /// Its corners in an order that does not depend on how it is stored, so that neither does rounding.
  std::array<int, 3> in_order(const RefinedFace& face) const {
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int p, int q) { return precedes(corner(face, p).eye, corner(face, q).eye); });
    return order;
  }

  bool is_well_inside(const RefinedFace& face) const {
    const MappedPoint &a = corner(face, 0), &b = corner(face, 1), &c = corner(face, 2);
    const auto length2 = [](const Vec3& p, const Vec3& q) { return glm::dot(q - p, q - p); };
    return oracle_.is_well_inside(std::max({length2(a.eye, b.eye), length2(b.eye, c.eye), length2(c.eye, a.eye)}), a, b, c);
  }

  /// Barycentric weights of the vertex that a finished face still needs inside, if any: where a principal axis
  /// pierces it although it is on the other side of a cone, where it comes nearest to the eye although that is inside
  /// the near sphere, or at the centroid when the interior is farther off than the edges.
  std::optional<Vec3> inner_vertex(const RefinedFace& face, int hidden_by) {
    const std::array<int, 3> order = in_order(face);
    const Vec3 a = corner(face, order[0]).eye, b = corner(face, order[1]).eye, c = corner(face, order[2]).eye;
    const Vec3 normal = glm::cross(b - a, c - a);
    const double area2 = glm::dot(normal, normal);
    const auto& boundaries = oracle_.region().boundaries;
    for (int i = 0; i < static_cast<int>(boundaries.size()); ++i) {
      if (hidden_by >= 0 && hidden_by != i) continue;
      const bool is_sphere = boundaries[i].kind == Boundary::Kind::near_sphere;
      const double along = is_sphere ? area2 : normal.z;
      if (along == 0) continue;
      const double distance = glm::dot(normal, a) / along;
      const Vec3 hit = is_sphere ? normal * distance : Vec3(0, 0, distance);
      const double side = signed_distance(boundaries[i], hit);
      if (hidden_by < 0 ? side >= 0 : side <= 0) continue;
      const auto weights = weights_inside(a, b, c, hit, normal, area2);
      if (!weights) continue;
      Vec3 stored;
      for (int k = 0; k < 3; ++k) stored[order[k]] = (*weights)[k];
      return stored;
    }
    if (hidden_by >= 0) return std::nullopt;
    return error_vertex(face);
  }

  std::optional<Vec3> error_vertex(const RefinedFace& face) {
    std::array<SideBound, 3> side;
    bool certified = !oracle_.has_fold();
    for (int k = 0; k < 3; ++k) {
      const RefinedEdge& edge = mesh_.edges[face.edge[k]];
      side[k] = {edge.middle_error, edge.arch, edge.depth_error};
      certified = certified && edge.certified;
    }
    const MappedPoint &a = corner(face, 0), &b = corner(face, 1), &c = corner(face, 2);
    const double depth_before = block_.judgement.depth_error;
    if (oracle_.is_good({&a, &b, &c}, side, first_depth + face.insertions, block_.judgement)) return std::nullopt;
    block_.judgement.depth_error = depth_before; // what is not kept is not counted
    const std::optional<InnerPlane> inside = inner_plane(state_, face.source);
    if (inside && oracle_.may_slide({&a, &b, &c}, side, *inside, first_depth + face.insertions, block_.judgement)) return std::nullopt;
    const bool is_hopeless = !certified || face.insertions >= most_insertions;
    const double tolerance = inside ? inside->tolerance : oracle_.options().tolerance;
    if (!is_hopeless || !oracle_.looks_good(a, b, c, tolerance, block_.judgement)) {
      block_.judgement.depth_error = depth_before;
      return Vec3(1.0 / 3.0);
    }
    ++block_.uncertified;
    return std::nullopt;
  }

  void insert(const RefinedFace& face, const Vec3& weights) {
    Vec3 eye(0);
    for (const int k : in_order(face)) eye += corner(face, k).eye * weights[k];
    const std::uint32_t point = local_bit | static_cast<std::uint32_t>(block_.points.size());
    const std::uint32_t wedge = local_bit | static_cast<std::uint32_t>(block_.wedges.size());
    block_.points.push_back(oracle_.locate(eye));
    ++block_.judgement.evaluations;
    block_.wedges.push_back({face.wedge, {weights.x, weights.y, weights.z}, point, state_.soup.faces[face.source].part});
    const std::uint32_t spoke = local_bit | static_cast<std::uint32_t>(block_.edges.size());
    for (int k = 0; k < 3; ++k) block_.edges.push_back({face.point[k], point, face.source});
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      block_.active.push_back({{face.point[k], face.point[next], point},
                              {face.wedge[k], face.wedge[next], wedge},
                              {face.edge[k], spoke + static_cast<std::uint32_t>(next), spoke + static_cast<std::uint32_t>(k)},
                              face.source,
                              static_cast<std::uint8_t>(std::min(255, face.insertions + 1))});
    }
  }

  const LevelState& state_;
  const RefinedMesh& mesh_;
  const EdgeOracle& oracle_;
  FaceBlock& block_;
};

/// Where the results of a block go.
struct Places {
  std::size_t points, wedges, edges, active, final;
};

/// Moves a block's results to their places, local ids made global.
void place(LevelState& state, const FaceBlock& block, const Places& at) {
  RefinedMesh& mesh = state.mesh;
  const auto globalise = [](std::uint32_t id, std::size_t first) {
    return id & local_bit ? static_cast<std::uint32_t>(first + (id & ~local_bit)) : id;
  };
  std::copy(block.points.begin(), block.points.end(), mesh.points.begin() + static_cast<std::ptrdiff_t>(at.points));
  for (std::size_t i = 0; i < block.wedges.size(); ++i) {
    mesh.wedges[at.wedges + i] = block.wedges[i];
    mesh.wedges[at.wedges + i].point = globalise(block.wedges[i].point, at.points);
  }
  for (std::size_t i = 0; i < block.edges.size(); ++i) {
    const InnerEdge& inner = block.edges[i];
    RefinedEdge& edge = mesh.edges[at.edges + i] = edge_of(mesh.points, globalise(inner.p, at.points), globalise(inner.q, at.points), inner.source, true);
    edge.second = inner.second;
    edge.depth_error = inner.depth;
  }
  for (std::size_t i = 0; i < block.active.size(); ++i) {
    RefinedFace face = block.active[i];
    for (int k = 0; k < 3; ++k) {
      face.point[k] = globalise(face.point[k], at.points);
      face.wedge[k] = globalise(face.wedge[k], state.first_wedge + at.wedges);
      face.edge[k] = globalise(face.edge[k], at.edges);
    }
    state.active[at.active + i] = face;
  }
  std::copy(block.final.begin(), block.final.end(), mesh.faces.begin() + static_cast<std::ptrdiff_t>(at.final));
}

/// Joins the blocks in order; they are empty afterwards.
void join(LevelState& state, std::vector<FaceBlock>& blocks) {
  RefinedMesh& mesh = state.mesh;
  Places end{mesh.points.size(), mesh.wedges.size(), mesh.edges.size(), 0, mesh.faces.size()};
  std::vector<Places> places;
  places.reserve(blocks.size());
  for (const FaceBlock& block : blocks) {
    places.push_back(end);
    end = {end.points + block.points.size(), end.wedges + block.wedges.size(), end.edges + block.edges.size(), end.active + block.active.size(),
           end.final + block.final.size()};
    mesh.clipped += block.clipped;
    mesh.off_picture += block.off_picture;
    mesh.uncertified_faces += block.uncertified;
    mesh.evaluations += block.judgement.evaluations;
    mesh.face_depth_error = std::max(mesh.face_depth_error, block.judgement.depth_error);
  }
  mesh.points.resize(end.points);
  mesh.wedges.resize(end.wedges);
  mesh.edges.resize(end.edges);
  mesh.faces.resize(end.final);
  state.active.resize(end.active);
  parallel_each(blocks.size(), 1, [&](std::size_t i) {
    place(state, blocks[i], places[i]);
    blocks[i] = {};
  });
  mesh.wedge_groups.push_back(mesh.wedges.size());
}

} // namespace

int hiding_boundary(const LevelState& state, const RefinedFace& face) {
  const auto corner = [&](int k) -> const MappedPoint& { return corner_of(state.mesh, face, k); };
  const auto& boundaries = state.oracle.region().boundaries;
  for (std::size_t i = 0; i < boundaries.size(); ++i) {
    const auto [low, high] = std::minmax({corner(0).sides[i], corner(1).sides[i], corner(2).sides[i]});
    if (high > 0) continue;
    if (low < 0) return static_cast<int>(i);
    // All corners on a cone. Where that opens by 90 degrees, so that its chords lie on it, the face is seen edge-on: drawn.
    const Vec3 centroid = (corner(0).eye + corner(1).eye + corner(2).eye) / 3.0;
    if (sides_of(state.oracle.region(), centroid)[i] < 0) return static_cast<int>(i);
  }
  return -1;
}

void split_faces(LevelState& state) {
  const std::vector<Triangle> middles = add_middle_wedges(state);
  std::vector<FaceBlock> blocks(level_blocks(state.active.size()));
  parallel_each(blocks.size(), 1, [&](std::size_t i) {
    FaceSplitter splitter(state, blocks[i]);
    const std::size_t begin = i * level_block, end = std::min(state.active.size(), begin + level_block);
    for (std::size_t f = begin; f < end; ++f) splitter.split(state.active[f], middles[f]);
  });
  state.active.clear();
  join(state, blocks);
}

} // namespace domewarp
