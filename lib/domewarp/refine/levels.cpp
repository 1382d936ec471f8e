// SPDX-License-Identifier: Apache-2.0
// Based on: level-synchronous templates over shared edge records (Hatipoglu and Ozturan 2015 for the parallel
// structure, without their propagation: every mark is needed by its own edge). Work is cut into blocks of fixed size
// whose results are joined in order, so the number of threads cannot show.
#include "domewarp/refine/levels.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/weld.h"
#include "domewarp/refine/flips.h"
#include "domewarp/refine/pattern_choice.h"

namespace domewarp {

namespace {

constexpr std::size_t block_size = 2048;
constexpr std::size_t deepest_level = 200; ///< twice what halving a double's range of angles could ever need
constexpr int most_unflipping_rounds = 12;    ///< each takes three quarters of a side's bend away
constexpr int first_depth = 2;     ///< a face is judged in 16 parts, and more finely after each insertion
constexpr int most_insertions = 4; ///< faces that their bound never proves good (long slivers beside the eye) would go on for ever
constexpr std::uint32_t local_bit = 0x80000000; ///< marks ids that count from the start of a block's own results

std::size_t block_count(std::size_t items) { return (items + block_size - 1) / block_size; }

/// What one block of faces turns into.
struct FaceBlock {
  std::vector<RefinedFace> active, final;
  std::vector<std::array<std::uint32_t, 2>> edges; ///< point ids of new inner edges
  std::vector<MappedPoint> points;                 ///< inserted inside faces
  std::vector<Wedge> wedges;
  std::size_t clipped = 0, off_picture = 0, uncertified = 0;
  std::size_t evaluations = 0;
};

class Refiner {
public:
  Refiner(const Soup& soup, const EdgeOracle& oracle, const PictureCull* cull) : soup_(soup), oracle_(oracle), cull_(cull) {
    mesh_.points.resize(soup.points.size());
    parallel_each(soup.points.size(), block_size, [&](std::size_t i) { mesh_.points[i] = oracle.locate(soup.points[i]); });
    mesh_.evaluations = soup.points.size();
    first_wedge_ = static_cast<std::uint32_t>(soup.wedge_point.size() + soup.extra_wedges.size());
    for (std::uint32_t e = 0; e < soup.topology.edges.size(); ++e)
      add_edge(soup.topology.edges[e].a, soup.topology.edges[e].b, e);
    active_.resize(soup.faces.size());
    for (std::uint32_t f = 0; f < active_.size(); ++f)
      active_[f] = {soup.faces[f].point, soup.faces[f].wedge, soup.topology.edges_of[f], f};
    if (cull != nullptr) mesh_.off_picture = std::erase_if(active_, [&](const RefinedFace& face) { return is_off_picture(face); });
  }

  RefinedMesh run(std::size_t max_triangles) {
    settle(0, max_triangles);
    for (int round = 0; round < most_unflipping_rounds && !mesh_.stopped; ++round) {
      const std::size_t first_new = mesh_.edges.size();
      if (!split_flipped_faces()) break;
      settle(first_new, max_triangles);
    }
    sort_faces();
    return std::move(mesh_);
  }

private:
  /// Decides about all edges from `decided` on and splits, until no face asks for more.
  void settle(std::size_t decided, std::size_t max_triangles) {
    while (!active_.empty()) {
      decided = split_edges(decided);
      split_faces();
      ++mesh_.levels;
      if (mesh_.faces.size() + active_.size() <= max_triangles && mesh_.levels < deepest_level) continue;
      mesh_.stopped = true;
      finish_early(decided);
    }
  }

  /// Halves the sides that turn faces over, for all the faces on them. False when there are none.
  bool split_flipped_faces() {
    const std::vector<std::uint32_t> sides =
        sides_of_flipped_faces(mesh_, oracle_.orientation(), 1e-3 * oracle_.options().tolerance);
    first_split_edge_ = 0;
    split_slot_.assign(mesh_.edges.size(), RefinedEdge::none);
    std::uint32_t slots = 0;
    for (const std::uint32_t e : sides)
      if (const std::optional<MappedPoint> middle = oracle_.middle(mesh_.points[mesh_.edges[e].a], mesh_.points[mesh_.edges[e].b])) {
        split_slot_[e] = slots++;
        halve(e, *middle);
      }
    mesh_.evaluations += slots;
    middle_wedges_.clear();
    first_middle_wedge_.assign(slots, RefinedEdge::none);
    const auto is_whole = [&](const RefinedFace& face) {
      return std::none_of(face.edge.begin(), face.edge.end(), [&](std::uint32_t e) { return is_split(e); });
    };
    const auto touched = std::stable_partition(mesh_.faces.begin(), mesh_.faces.end(), is_whole);
    active_.assign(touched, mesh_.faces.end());
    mesh_.faces.erase(touched, mesh_.faces.end());
    split_faces();
    return slots > 0;
  }

  void add_edge(std::uint32_t p, std::uint32_t q, std::uint32_t source) {
    RefinedEdge edge;
    const bool in_order = precedes(mesh_.points[p].eye, mesh_.points[q].eye);
    edge.a = in_order ? p : q;
    edge.b = in_order ? q : p;
    edge.source = source;
    mesh_.edges.push_back(edge);
  }

  /// Decides about all edges from `first` on and splits those that must be. Returns the first undecided edge.
  std::size_t split_edges(std::size_t first) {
    const std::size_t end = mesh_.edges.size();
    const std::vector<std::uint8_t> is_used = used_edges(first);
    struct Block {
      std::vector<std::pair<std::uint32_t, MappedPoint>> splits;
      std::size_t evaluations = 0;
    };
    std::vector<Block> blocks(block_count(end - first));
    parallel_each(blocks.size(), 1, [&](std::size_t i) {
      const std::size_t begin = first + i * block_size;
      for (std::size_t e = begin; e < std::min(end, begin + block_size); ++e) {
        if (!is_used[e - first]) continue;
        RefinedEdge& edge = mesh_.edges[e];
        const EdgeDecision decision = oracle_.decide(mesh_.points[edge.a], mesh_.points[edge.b]);
        edge.error = decision.error;
        edge.depth_error = decision.depth_error;
        edge.middle_error = decision.middle;
        edge.arch = decision.arch;
        edge.certified = decision.certified;
        blocks[i].evaluations += decision.evaluations;
        if (decision.split) blocks[i].splits.emplace_back(static_cast<std::uint32_t>(e), decision.split->point);
      }
    });
    first_split_edge_ = first;
    split_slot_.assign(end - first, RefinedEdge::none);
    std::uint32_t slots = 0;
    for (const Block& block : blocks) {
      mesh_.evaluations += block.evaluations;
      for (const auto& [e, point] : block.splits) {
        split_slot_[e - first] = slots++;
        halve(e, point);
      }
    }
    middle_wedges_.clear();
    first_middle_wedge_.assign(slots, RefinedEdge::none);
    return end;
  }

  void halve(std::uint32_t e, const MappedPoint& point) {
    const std::uint32_t middle = static_cast<std::uint32_t>(mesh_.points.size());
    mesh_.points.push_back(point);
    const RefinedEdge edge = mesh_.edges[e];
    mesh_.edges[e].middle = middle;
    mesh_.edges[e].child = static_cast<std::uint32_t>(mesh_.edges.size());
    add_edge(edge.a, middle, edge.source);
    add_edge(middle, edge.b, edge.source);
  }

  bool is_split(std::uint32_t edge) const { return mesh_.edges[edge].middle != RefinedEdge::none; }

  /// The wedge at the middle of side k: one for all faces that have the same wedges at the side's ends.
  std::uint32_t middle_wedge(const RefinedFace& face, int k) {
    const RefinedEdge& edge = mesh_.edges[face.edge[k]];
    std::uint32_t wa = face.wedge[k], wb = face.wedge[(k + 1) % 3];
    if (edge.a != face.point[k]) std::swap(wa, wb);
    std::uint32_t& head = first_middle_wedge_[split_slot_[face.edge[k] - first_split_edge_]];
    for (std::uint32_t i = head; i != RefinedEdge::none; i = middle_wedges_[i].next)
      if (middle_wedges_[i].wa == wa && middle_wedges_[i].wb == wb) return middle_wedges_[i].wedge;
    const Vec3 a = mesh_.points[edge.a].eye, d = mesh_.points[edge.b].eye - a;
    const double t = glm::dot(mesh_.points[edge.middle].eye - a, d) / glm::dot(d, d);
    const std::uint32_t wedge = first_wedge_ + static_cast<std::uint32_t>(mesh_.wedges.size());
    mesh_.wedges.push_back({{wa, wb, wa}, {1 - t, t, 0}, edge.middle, soup_.faces[face.source].part});
    middle_wedges_.push_back({wa, wb, wedge, head});
    head = static_cast<std::uint32_t>(middle_wedges_.size() - 1);
    return wedge;
  }

  void split_faces() {
    std::vector<Triangle> middles(active_.size());
    for (std::size_t f = 0; f < active_.size(); ++f)
      for (int k = 0; k < 3; ++k)
        if (is_split(active_[f].edge[k])) middles[f][k] = middle_wedge(active_[f], k);
    std::vector<FaceBlock> blocks(block_count(active_.size()));
    parallel_each(blocks.size(), 1, [&](std::size_t i) {
      const std::size_t begin = i * block_size;
      for (std::size_t f = begin; f < std::min(active_.size(), begin + block_size); ++f) split_face(active_[f], middles[f], blocks[i]);
    });
    active_.clear();
    for (FaceBlock& block : blocks) append(block);
  }

  void split_face(const RefinedFace& face, const Triangle& middle_wedges, FaceBlock& block) const {
    unsigned marks = 0;
    for (int k = 0; k < 3; ++k) marks |= static_cast<unsigned>(is_split(face.edge[k])) << k;
    if (marks == 0) return finish_face(face, block);
    std::array<std::uint32_t, 6> point, wedge;
    for (int k = 0; k < 3; ++k) {
      point[k] = face.point[k];
      wedge[k] = face.wedge[k];
      point[3 + k] = mesh_.edges[face.edge[k]].middle;
      wedge[3 + k] = middle_wedges[k];
    }
    std::array<const MappedPoint*, 6> mapped{};
    for (std::size_t i = 0; i < 6; ++i) mapped[i] = point[i] == RefinedEdge::none ? nullptr : &mesh_.points[point[i]];
    const SplitPattern& pattern = choose_pattern(marks, mapped, oracle_);
    const std::uint32_t first_edge = static_cast<std::uint32_t>(block.edges.size());
    for (int i = 0; i < pattern.edges; ++i) block.edges.push_back({point[pattern.edge[i][0]], point[pattern.edge[i][1]]});
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
        ++block.off_picture;
      else
        block.active.push_back(part);
    }
  }

  /// Its corners must be points of the mesh already.
  bool is_off_picture(const RefinedFace& face) const {
    return cull_ != nullptr && !cull_->may_be_seen(corner(face, 0), corner(face, 1), corner(face, 2));
  }

  /// Flags of the edges from `first` on that some face still waits for; what only dropped faces had needs no decision.
  std::vector<std::uint8_t> used_edges(std::size_t first) const {
    std::vector<std::uint8_t> is_used(mesh_.edges.size() - first, cull_ == nullptr);
    if (cull_ == nullptr) return is_used;
    for (const RefinedFace& face : active_)
      for (const std::uint32_t e : face.edge)
        if (e >= first) is_used[e - first] = 1;
    return is_used;
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
  void finish_face(const RefinedFace& face, FaceBlock& block) const {
    const int hidden_by = hiding_boundary(face);
    if (const std::optional<Vec3> weights = inner_vertex(face, hidden_by, block)) return insert(face, *weights, block);
    if (hidden_by < 0)
      block.final.push_back(face);
    else
      ++block.clipped;
  }

  const MappedPoint& corner(const RefinedFace& face, int k) const { return mesh_.points[face.point[k]]; }

  /// The first boundary that a finished face lies outside of, or -1 when it is visible.
  int hiding_boundary(const RefinedFace& face) const {
    const auto& boundaries = oracle_.region().boundaries;
    for (std::size_t i = 0; i < boundaries.size(); ++i) {
      const auto [low, high] = std::minmax({corner(face, 0).sides[i], corner(face, 1).sides[i], corner(face, 2).sides[i]});
      if (high > 0) continue;
      const Vec3 centroid = (corner(face, 0).eye + corner(face, 1).eye + corner(face, 2).eye) / 3.0;
      if (low < 0 || signed_distance(boundaries[i], centroid) < 0) return static_cast<int>(i);
    }
    return -1;
  }

  /// Barycentric weights of the vertex that a finished face still needs inside, if any: where a principal axis
  /// pierces it although it is on the other side of a cone, where it comes nearest to the eye although that is inside
  /// the near sphere, or at the centroid when the interior is farther off than the edges.
  std::optional<Vec3> inner_vertex(const RefinedFace& face, int hidden_by, FaceBlock& block) const {
    const Vec3 a = corner(face, 0).eye, b = corner(face, 1).eye, c = corner(face, 2).eye;
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
      if (const auto weights = weights_inside(a, b, c, hit, normal, area2)) return weights;
    }
    if (hidden_by >= 0) return std::nullopt;
    return error_vertex(face, block);
  }

  static std::optional<Vec3> weights_inside(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& normal, double area2) {
    const Vec3 weights(glm::dot(normal, glm::cross(c - b, p - b)) / area2, glm::dot(normal, glm::cross(a - c, p - c)) / area2,
                       glm::dot(normal, glm::cross(b - a, p - a)) / area2);
    // A hit within rounding of an edge belongs to the edge, whose extremum has settled it.
    constexpr double margin = 1e-9;
    if (weights.x > margin && weights.y > margin && weights.z > margin) return weights;
    return std::nullopt;
  }

  std::optional<Vec3> error_vertex(const RefinedFace& face, FaceBlock& block) const {
    std::array<SideBound, 3> side;
    bool certified = !oracle_.has_fold();
    for (int k = 0; k < 3; ++k) {
      const RefinedEdge& edge = mesh_.edges[face.edge[k]];
      side[k] = {edge.middle_error, edge.arch};
      certified = certified && edge.certified;
    }
    const MappedPoint &a = corner(face, 0), &b = corner(face, 1), &c = corner(face, 2);
    if (oracle_.is_good({&a, &b, &c}, side, first_depth + face.insertions, block.evaluations)) return std::nullopt;
    if ((certified && face.insertions < most_insertions) || !oracle_.looks_good(a, b, c, block.evaluations)) return Vec3(1.0 / 3.0);
    ++block.uncertified;
    return std::nullopt;
  }

  void insert(const RefinedFace& face, const Vec3& weights, FaceBlock& block) const {
    const Vec3 eye = corner(face, 0).eye * weights.x + corner(face, 1).eye * weights.y + corner(face, 2).eye * weights.z;
    const std::uint32_t point = local_bit | static_cast<std::uint32_t>(block.points.size());
    const std::uint32_t wedge = local_bit | static_cast<std::uint32_t>(block.wedges.size());
    block.points.push_back(oracle_.locate(eye));
    ++block.evaluations;
    block.wedges.push_back({face.wedge, {weights.x, weights.y, weights.z}, point, soup_.faces[face.source].part});
    const std::uint32_t spoke = local_bit | static_cast<std::uint32_t>(block.edges.size());
    for (int k = 0; k < 3; ++k) block.edges.push_back({face.point[k], point});
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      block.active.push_back({{face.point[k], face.point[next], point},
                              {face.wedge[k], face.wedge[next], wedge},
                              {face.edge[k], spoke + static_cast<std::uint32_t>(next), spoke + static_cast<std::uint32_t>(k)},
                              face.source,
                              static_cast<std::uint8_t>(std::min(255, face.insertions + 1))});
    }
  }

  void append(FaceBlock& block) {
    const std::uint32_t points = static_cast<std::uint32_t>(mesh_.points.size());
    const std::uint32_t wedges = first_wedge_ + static_cast<std::uint32_t>(mesh_.wedges.size());
    const std::uint32_t edges = static_cast<std::uint32_t>(mesh_.edges.size());
    const auto globalise = [](std::uint32_t& id, std::uint32_t first) {
      if (id & local_bit) id = first + (id & ~local_bit);
    };
    mesh_.points.insert(mesh_.points.end(), block.points.begin(), block.points.end());
    for (Wedge& wedge : block.wedges) {
      globalise(wedge.point, points);
      mesh_.wedges.push_back(wedge);
    }
    for (auto& [p, q] : block.edges) {
      globalise(p, points);
      globalise(q, points);
      add_edge(p, q, RefinedEdge::none);
    }
    for (RefinedFace& face : block.active)
      for (int k = 0; k < 3; ++k) {
        globalise(face.point[k], points);
        globalise(face.wedge[k], wedges);
        globalise(face.edge[k], edges);
      }
    active_.insert(active_.end(), block.active.begin(), block.active.end());
    mesh_.faces.insert(mesh_.faces.end(), block.final.begin(), block.final.end());
    mesh_.clipped += block.clipped;
    mesh_.off_picture += block.off_picture;
    mesh_.uncertified_faces += block.uncertified;
    mesh_.evaluations += block.evaluations;
  }

  /// The limit is reached: what is there is drawn as it is, with the errors it has.
  void finish_early(std::size_t first_undecided) {
    for (std::size_t e = first_undecided; e < mesh_.edges.size(); ++e) {
      RefinedEdge& edge = mesh_.edges[e];
      edge.error = static_cast<float>(oracle_.diagonal_error(mesh_.points[edge.a], mesh_.points[edge.b]));
    }
    for (const RefinedFace& face : active_)
      if (hiding_boundary(face) < 0) mesh_.faces.push_back(face);
    active_.clear();
  }

  void sort_faces() {
    std::stable_sort(mesh_.faces.begin(), mesh_.faces.end(),
                     [](const RefinedFace& x, const RefinedFace& y) { return x.source < y.source; });
  }

  struct MiddleWedge {
    std::uint32_t wa, wb, wedge, next;
  };

  const Soup& soup_;
  const EdgeOracle& oracle_;
  const PictureCull* cull_;
  RefinedMesh mesh_;
  std::vector<RefinedFace> active_;
  std::uint32_t first_wedge_ = 0;
  std::size_t first_split_edge_ = 0;
  std::vector<std::uint32_t> split_slot_;         ///< per edge decided in this level
  std::vector<std::uint32_t> first_middle_wedge_; ///< per split edge of this level, into middle_wedges_
  std::vector<MiddleWedge> middle_wedges_;
};

} // namespace

RefinedMesh refine_levels(const Soup& soup, const EdgeOracle& oracle, std::size_t max_triangles, const PictureCull* cull) {
  return Refiner(soup, oracle, cull).run(max_triangles);
}

} // namespace domewarp
