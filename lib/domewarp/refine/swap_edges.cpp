// SPDX-License-Identifier: Apache-2.0
// Based on: longest-edge bisection (Rivara 1984) inside the faces of the source, with look-ahead: before an edge is split,
// the other diagonal of its two faces is tried, as Lawson's flips do.
#include <algorithm>
#include <atomic>
#include <optional>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/weld.h"
#include "domewarp/refine/flips.h"
#include "domewarp/refine/level_state.h"

namespace domewarp {

namespace {

constexpr double thinnest = 1e-3;     ///< least share of the area of a square on the longest side that a new face has, twice
constexpr double better = 0.5;        ///< an edge that must be split itself has at most this share of the other's excess
constexpr double promising = 2;       ///< how much larger than the other's excess a bound may be for the edge to be asked about
constexpr double patience = 2;        ///< largest excess of an edge that waits: more only costs evaluations
constexpr std::uint8_t most_waits = 1; ///< levels; more saves little, and rows of edges each a little longer than the next would take one after the other
constexpr std::uint32_t no_face = 0xffffffff;

/// Up to two active faces on each wanted edge, in order; of an inner edge there are no more.
using FacesOf = std::vector<std::array<std::uint32_t, 2>>;

/// Whether another edge may take its place: nobody but two faces of one source face sees it.
bool can_be_other(const RefinedEdge& edge) { return edge.inner && edge.excess > 0; }

/// Whether it may stay whole for now: it is so nearly good that a neighbour's split may spare it its own.
bool can_wait(const RefinedEdge& edge) { return can_be_other(edge) && edge.excess <= patience; }

FacesOf list_faces(const LevelState& state) {
  FacesOf faces(state.wanted.size(), {no_face, no_face});
  parallel_each(state.active.size(), level_block, [&](std::size_t f) {
    for (const std::uint32_t e : state.active[f].edge) {
      if (!state.mesh.edges[e].wanted) continue;
      auto& of = faces[state.mesh.edges[e].child];
      std::uint32_t none = no_face;
      if (!std::atomic_ref(of[0]).compare_exchange_strong(none, static_cast<std::uint32_t>(f))) std::atomic_ref(of[1]).store(static_cast<std::uint32_t>(f));
    }
  });
  for (auto& of : faces)
    if (of[1] != no_face && of[0] > of[1]) std::swap(of[0], of[1]);
  return faces;
}

void number_wanted(LevelState& state) {
  for (std::size_t i = 0; i < state.wanted.size(); ++i) {
    RefinedEdge& edge = state.mesh.edges[state.wanted[i].first];
    edge.wanted = true;
    edge.child = static_cast<std::uint32_t>(i);
  }
}

/// By the ends, so that no order of storage can show.
bool stands_before(const RefinedMesh& mesh, const RefinedEdge& x, const RefinedEdge& y) {
  const Vec3 &a = mesh.points[x.a].eye, &b = mesh.points[y.a].eye;
  return a == b ? precedes(mesh.points[x.b].eye, mesh.points[y.b].eye) : precedes(a, b);
}

/// The other edge of two faces and the faces beside it.
struct Swap {
  RefinedEdge edge;
  std::optional<MappedPoint> middle; ///< where the new edge must be split
  std::array<RefinedFace, 2> face;
};

class Swapper {
public:
  explicit Swapper(const LevelState& state) : state_(state), mesh_(state.mesh) {}

  std::optional<Swap> swap(std::uint32_t e, const RefinedFace& first, const RefinedFace& second, std::size_t& evaluations) const {
    const RefinedEdge& old = mesh_.edges[e];
    const bool runs_along = first.point[side_of(first, e)] == old.a; // neither order nor winding may show, not even in rounding
    const RefinedFace &x = runs_along ? first : second, &y = runs_along ? second : first;
    const int k = side_of(x, e), j = side_of(y, e);
    const auto at = [](int i) { return i % 3; };
    const std::uint32_t a = x.point[k], b = x.point[at(k + 1)], c = x.point[at(k + 2)], d = y.point[at(j + 2)];
    if (x.point[k] != old.a || y.point[j] != b) return std::nullopt; // they do not turn alike: not the two of one plane
    const auto turns = turning_of(old.source);
    if (!turns || !is_seen({a, b, c, d}) || !is_upright(a, d, c, *turns) || !is_upright(b, c, d, *turns)) return std::nullopt;
    Swap swap{edge_of(mesh_.points, c, d, old.source, true), {}, {}};
    if (is_chord(old) || is_chord(swap.edge) || !decide(old, swap, evaluations)) return std::nullopt;
    const std::uint8_t insertions = std::max(x.insertions, y.insertions);
    swap.face[0] = {{a, d, c}, {x.wedge[k], y.wedge[at(j + 2)], x.wedge[at(k + 2)]}, {y.edge[at(j + 1)], e, x.edge[at(k + 2)]}, x.source, insertions};
    swap.face[1] = {{d, b, c}, {y.wedge[at(j + 2)], y.wedge[j], x.wedge[at(k + 2)]}, {y.edge[at(j + 2)], x.edge[at(k + 1)], e}, x.source, insertions};
    return swap;
  }

private:
  static int side_of(const RefinedFace& face, std::uint32_t e) { return face.edge[0] == e ? 0 : face.edge[1] == e ? 1 : 2; }

  /// The normal of a face of the soup.
  std::optional<Vec3> turning_of(std::uint32_t source) const {
    const Triangle p = points_of(state_.soup, state_.soup.faces[source]);
    const Vec3 a = state_.soup.points[p[0]], normal = glm::cross(state_.soup.points[p[1]] - a, state_.soup.points[p[2]] - a);
    const double size = glm::length(normal);
    return size > 0 ? std::optional(normal / size) : std::nullopt;
  }

  bool is_seen(const std::array<std::uint32_t, 4>& corners) const {
    return std::ranges::all_of(corners, [&](std::uint32_t p) { return std::ranges::min(mesh_.points[p].sides) >= 0; });
  }

  bool is_chord(const RefinedEdge& edge) const { return share_boundary(mesh_.points[edge.a].sides, mesh_.points[edge.b].sides); }

  /// Whether the corners turn like the face of the source, in space and in the image, and are not nearly on a line.
  bool is_upright(std::uint32_t p, std::uint32_t q, std::uint32_t r, const Vec3& normal) const {
    const std::array<const MappedPoint*, 3> corner{&mesh_.points[p], &mesh_.points[q], &mesh_.points[r]};
    const Vec3 u = corner[1]->eye - corner[0]->eye, v = corner[2]->eye - corner[0]->eye, w = v - u;
    if (!(glm::dot(glm::cross(u, v), normal) > thinnest * std::max({glm::dot(u, u), glm::dot(v, v), glm::dot(w, w)}))) return false;
    return !is_flipped(corner, state_.oracle.orientation(), state_.oracle.options().turned_thickness);
  }

  /// Whether the new edge is better than the old one.
  bool decide(const RefinedEdge& old, Swap& swap, std::size_t& evaluations) const {
    const MappedPoint &low = mesh_.points[swap.edge.a], &high = mesh_.points[swap.edge.b];
    const DiagonalBound bound = state_.oracle.diagonal(low, high);
    if (!(bound.error <= promising * old.excess * state_.oracle.options().tolerance)) return false;
    const std::optional<InnerPlane> inside = inner_plane(state_, old.source);
    const EdgeDecision decision = state_.oracle.decide(low, high, {bound.bend ? &*bound.bend : nullptr, inside ? &*inside : nullptr});
    evaluations += decision.evaluations;
    note(decision, swap.edge);
    if (!decision.split) return true;
    swap.middle = decision.split->point;
    return decision.excess > 0 && decision.excess <= better * old.excess;
  }

  const LevelState& state_;
  const RefinedMesh& mesh_;
};

} // namespace

void swap_edges(LevelState& state) {
  RefinedMesh& mesh = state.mesh;
  number_wanted(state);
  const FacesOf faces = list_faces(state);
  std::vector<std::optional<Swap>> swaps(state.wanted.size());
  std::vector<std::size_t> evaluations(level_blocks(swaps.size()), 0);
  parallel_each(evaluations.size(), 1, [&](std::size_t block) {
    const Swapper swapper(state);
    for (std::size_t i = block * level_block; i < std::min(swaps.size(), (block + 1) * level_block); ++i) {
      const std::uint32_t e = state.wanted[i].first;
      if (!can_be_other(mesh.edges[e]) || mesh.edges[e].swapped || faces[i][1] == no_face) continue;
      const RefinedFace &x = state.active[faces[i][0]], &y = state.active[faces[i][1]];
      if (x.is_new || y.is_new) swaps[i] = swapper.swap(e, x, y, evaluations[block]);
    }
  });
  for (const std::size_t count : evaluations) mesh.evaluations += count;
  // A face takes part in one swap: that of the side with the greatest excess.
  const auto is_chosen = [&](std::size_t i) {
    const RefinedEdge& edge = mesh.edges[state.wanted[i].first];
    for (const std::uint32_t f : faces[i])
      for (const std::uint32_t e : state.active[f].edge) {
        const RefinedEdge& other = mesh.edges[e];
        if (e == state.wanted[i].first || !other.wanted || !swaps[other.child]) continue;
        if (other.excess != edge.excess ? other.excess > edge.excess : stands_before(mesh, other, edge)) return false;
      }
    return true;
  };
  std::vector<std::uint8_t> chosen(swaps.size(), 0);
  parallel_each(swaps.size(), level_block, [&](std::size_t i) { chosen[i] = swaps[i] && is_chosen(i); });
  parallel_each(state.active.size(), level_block, [&](std::size_t f) { state.active[f].is_new = false; });
  parallel_each(swaps.size(), level_block, [&](std::size_t i) {
    if (!chosen[i]) {
      if (swaps[i]) std::atomic_ref(state.active[faces[i][0]].is_new).store(true, std::memory_order_relaxed); // another time
      return;
    }
    RefinedEdge& edge = mesh.edges[state.wanted[i].first] = swaps[i]->edge;
    edge.swapped = true;
    edge.wanted = swaps[i]->middle.has_value();
    if (edge.wanted) state.wanted[i].second = *swaps[i]->middle;
    for (int k = 0; k < 2; ++k) state.active[faces[i][k]] = swaps[i]->face[k];
  });
  std::erase_if(state.wanted, [&](const auto& wish) { return !mesh.edges[wish.first].wanted; });
}

EdgeSplits choose_splits(LevelState& state) {
  RefinedMesh& mesh = state.mesh;
  number_wanted(state);
  std::vector<std::uint8_t> waits(state.wanted.size(), 0), is_used(state.wanted.size(), 0);
  const auto length2 = [&](const RefinedEdge& edge) {
    const Vec3 d = mesh.points[edge.b].eye - mesh.points[edge.a].eye;
    return glm::dot(d, d);
  };
  const auto goes_before = [&](const RefinedEdge& x, const RefinedEdge& y) {
    if (can_wait(x) != can_wait(y)) return can_wait(y);
    const double lx = length2(x), ly = length2(y);
    return lx != ly ? lx > ly : stands_before(mesh, x, y);
  };
  parallel_each(state.active.size(), level_block, [&](std::size_t f) {
    const RefinedEdge* first = nullptr;
    for (const std::uint32_t e : state.active[f].edge) {
      const RefinedEdge& edge = mesh.edges[e];
      if (!edge.wanted) continue;
      std::atomic_ref(is_used[edge.child]).store(1, std::memory_order_relaxed);
      if (first == nullptr || goes_before(edge, *first)) first = &edge;
    }
    for (const std::uint32_t e : state.active[f].edge)
      if (const RefinedEdge& edge = mesh.edges[e]; edge.wanted && &edge != first && can_wait(edge))
        std::atomic_ref(waits[edge.child]).store(1, std::memory_order_relaxed);
  });
  EdgeSplits now, later;
  for (std::size_t i = 0; i < waits.size(); ++i) {
    RefinedEdge& edge = mesh.edges[state.wanted[i].first];
    waits[i] = waits[i] && edge.waited++ < most_waits;
    edge.wanted = is_used[i] && waits[i];
    if (is_used[i]) (waits[i] ? later : now).push_back(state.wanted[i]);
  }
  state.wanted = std::move(later);
  return now;
}

} // namespace domewarp
