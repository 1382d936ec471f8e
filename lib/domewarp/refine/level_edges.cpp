// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <numeric>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/refine/level_state.h"

namespace domewarp {

namespace {

/// Flags of the edges from `first` on that some face still waits for; what only dropped faces had needs no decision.
std::vector<std::uint8_t> used_edges(const LevelState& state, std::size_t first) {
  std::vector<std::uint8_t> is_used(state.mesh.edges.size() - first, state.cull == nullptr);
  if (state.cull == nullptr) return is_used;
  parallel_each(state.active.size(), level_block, [&](std::size_t f) {
    for (const std::uint32_t e : state.active[f].edge)
      if (e >= first) std::atomic_ref(is_used[e - first]).store(1, std::memory_order_relaxed);
  });
  return is_used;
}

} // namespace

void note(const EdgeDecision& decision, RefinedEdge& edge) {
  edge.error = decision.error;
  edge.depth_error = decision.depth_error;
  edge.middle_error = decision.middle;
  edge.excess = decision.excess;
  edge.arch = decision.arch;
  edge.certified = decision.certified;
  edge.slides = decision.slides;
}

void halve_edges(LevelState& state, const std::vector<EdgeSplits>& blocks) {
  RefinedMesh& mesh = state.mesh;
  std::vector<std::size_t> before(blocks.size() + 1, 0);
  for (std::size_t i = 0; i < blocks.size(); ++i) before[i + 1] = before[i] + blocks[i].size();
  const std::size_t first_point = mesh.points.size(), first_edge = mesh.edges.size();
  mesh.points.resize(first_point + before.back());
  mesh.edges.resize(first_edge + 2 * before.back());
  state.first_middle = static_cast<std::uint32_t>(first_point);
  parallel_each(blocks.size(), 1, [&](std::size_t i) {
    std::size_t slot = before[i];
    for (const auto& [e, point] : blocks[i]) {
      RefinedEdge& edge = mesh.edges[e];
      edge.middle = static_cast<std::uint32_t>(first_point + slot);
      edge.child = static_cast<std::uint32_t>(first_edge + 2 * slot);
      mesh.points[edge.middle] = point;
      mesh.edges[edge.child] = edge_of(mesh.points, edge.a, edge.middle, edge.source, edge.inner);
      mesh.edges[edge.child + 1] = edge_of(mesh.points, edge.middle, edge.b, edge.source, edge.inner);
      ++slot;
    }
  });
}

std::size_t decide_edges(LevelState& state, std::size_t first) {
  RefinedMesh& mesh = state.mesh;
  const std::size_t end = mesh.edges.size();
  const std::vector<std::uint8_t> is_used = used_edges(state, first);
  std::vector<EdgeSplits> splits(level_blocks(end - first));
  std::vector<std::size_t> evaluations(splits.size(), 0);
  std::vector<float> slide_depth(splits.size(), mesh.slide_depth_error);
  parallel_each(splits.size(), 1, [&](std::size_t i) {
    const std::size_t begin = first + i * level_block;
    for (std::size_t e = begin; e < std::min(end, begin + level_block); ++e) {
      if (!is_used[e - first]) continue;
      RefinedEdge& edge = mesh.edges[e];
      const EdgeBend known{edge.second, edge.depth_error};
      const std::optional<InnerPlane> inside = edge.inner ? inner_plane(state, edge.source) : std::nullopt;
      const EdgeDecision decision =
          state.oracle.decide(mesh.points[edge.a], mesh.points[edge.b], {known.second >= 0 ? &known : nullptr, inside ? &*inside : nullptr});
      if (decision.slides) slide_depth[i] = std::max(slide_depth[i], decision.slide_depth);
      note(decision, edge);
      evaluations[i] += decision.evaluations;
      if (decision.split) splits[i].emplace_back(static_cast<std::uint32_t>(e), decision.split->point);
    }
  });
  mesh.evaluations = std::accumulate(evaluations.begin(), evaluations.end(), mesh.evaluations);
  for (const float depth : slide_depth) mesh.slide_depth_error = std::max(mesh.slide_depth_error, depth);
  for (const EdgeSplits& block : splits) state.wanted.insert(state.wanted.end(), block.begin(), block.end());
  return end;
}

namespace {

/// A split side: the wedges at its ends, in the order of its edge.
struct SplitSide {
  std::uint32_t wa, wb;
  std::uint32_t side; ///< 3 * active face + k
};

/// Split sides sorted by edge, then side; `begin[slot]` is the first of the slot-th split edge.
struct SplitSides {
  std::vector<std::uint32_t> begin;
  std::vector<SplitSide> sides;
};

SplitSides sort_split_sides(const LevelState& state) {
  const RefinedMesh& mesh = state.mesh;
  const std::size_t slots = mesh.points.size() - state.first_middle;
  std::vector<std::uint32_t> next(slots, 0);
  const auto each_side = [&](auto&& body) {
    parallel_each(state.active.size(), level_block, [&](std::size_t f) {
      for (int k = 0; k < 3; ++k)
        if (const RefinedEdge& edge = mesh.edges[state.active[f].edge[k]]; edge.middle != RefinedEdge::none)
          body(f, k, edge, std::atomic_ref(next[edge.middle - state.first_middle]).fetch_add(1, std::memory_order_relaxed));
    });
  };
  each_side([](std::size_t, int, const RefinedEdge&, std::uint32_t) {});
  SplitSides sorted;
  sorted.begin.resize(slots + 1, 0);
  std::partial_sum(next.begin(), next.end(), sorted.begin.begin() + 1);
  std::copy_n(sorted.begin.begin(), slots, next.begin());
  sorted.sides.resize(sorted.begin.back());
  each_side([&](std::size_t f, int k, const RefinedEdge& edge, std::uint32_t at) {
    const RefinedFace& face = state.active[f];
    std::uint32_t wa = face.wedge[k], wb = face.wedge[(k + 1) % 3];
    if (edge.a != face.point[k]) std::swap(wa, wb);
    sorted.sides[at] = {wa, wb, static_cast<std::uint32_t>(3 * f + k)};
  });
  parallel_each(slots, level_block, [&](std::size_t slot) { // undoes the threads' order
    std::sort(sorted.sides.begin() + sorted.begin[slot], sorted.sides.begin() + sorted.begin[slot + 1],
              [](const SplitSide& x, const SplitSide& y) { return x.side < y.side; });
  });
  return sorted;
}

/// Calls body(side, first) with the first of the slot's sides that has the same wedges.
template <typename Body>
void each_with_first(const SplitSides& sorted, std::size_t slot, Body&& body) {
  for (std::uint32_t i = sorted.begin[slot]; i < sorted.begin[slot + 1]; ++i) {
    std::uint32_t first = sorted.begin[slot];
    while (sorted.sides[first].wa != sorted.sides[i].wa || sorted.sides[first].wb != sorted.sides[i].wb) ++first;
    body(i, first);
  }
}

} // namespace

std::vector<Triangle> add_middle_wedges(LevelState& state) {
  RefinedMesh& mesh = state.mesh;
  const SplitSides sorted = sort_split_sides(state);
  const std::size_t slots = sorted.begin.size() - 1;
  std::vector<std::uint32_t> before(slots + 1, 0);
  parallel_each(slots, level_block, [&](std::size_t slot) {
    each_with_first(sorted, slot, [&](std::uint32_t i, std::uint32_t first) { before[slot + 1] += i == first; });
  });
  before[0] = static_cast<std::uint32_t>(mesh.wedges.size());
  std::partial_sum(before.begin(), before.end(), before.begin());
  mesh.wedges.resize(before.back());
  std::vector<Triangle> middles(state.active.size());
  parallel_each(slots, level_block, [&](std::size_t slot) {
    std::uint32_t next = before[slot];
    each_with_first(sorted, slot, [&](std::uint32_t i, std::uint32_t first) {
      const SplitSide& side = sorted.sides[i];
      std::uint32_t& own = middles[side.side / 3][side.side % 3];
      if (i != first) {
        own = middles[sorted.sides[first].side / 3][sorted.sides[first].side % 3];
        return;
      }
      const RefinedFace& face = state.active[side.side / 3];
      const RefinedEdge& edge = mesh.edges[face.edge[side.side % 3]];
      const Vec3 a = mesh.points[edge.a].eye, d = mesh.points[edge.b].eye - a;
      const double t = glm::dot(mesh.points[edge.middle].eye - a, d) / glm::dot(d, d);
      mesh.wedges[next] = {{side.wa, side.wb, side.wa}, {1 - t, t, 0}, edge.middle, state.soup.faces[face.source].part};
      own = state.first_wedge + next++;
    });
  });
  mesh.wedge_groups.push_back(mesh.wedges.size());
  return middles;
}

} // namespace domewarp
