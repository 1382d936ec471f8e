// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/levels.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "domewarp/refine/flips.h"
#include "domewarp/refine/level_state.h"

namespace domewarp {

namespace {

constexpr std::size_t deepest_level = 200; ///< twice what halving a double's range of angles could ever need
constexpr int most_unflipping_rounds = 64; ///< thin faces turn over one after the other; each split takes three quarters of a bend away

/// The limit is reached: what is there is drawn as it is, with the errors it has.
void finish_early(LevelState& state, std::size_t first_undecided) {
  RefinedMesh& mesh = state.mesh;
  for (std::size_t e = first_undecided; e < mesh.edges.size(); ++e) {
    RefinedEdge& edge = mesh.edges[e];
    edge.error = static_cast<float>(state.oracle.diagonal(mesh.points[edge.a], mesh.points[edge.b]).error);
  }
  for (const RefinedFace& face : state.active)
    if (hiding_boundary(state, face) < 0) mesh.faces.push_back(face);
  state.active.clear();
}

/// Decides about all edges from `decided` on and splits, until no face asks for more.
void settle(LevelState& state, std::size_t decided, std::size_t max_triangles) {
  RefinedMesh& mesh = state.mesh;
  for (std::size_t level = 1; !state.active.empty(); ++level) {
    decided = decide_edges(state, decided);
    const bool asks = static_cast<bool>(state.oracle.options().criterion); // which wants edges short, not few
    if (!asks) swap_edges(state);
    halve_edges(state, {asks ? std::exchange(state.wanted, {}) : choose_splits(state)});
    split_faces(state);
    ++mesh.levels;
    if (mesh.whole.size() + mesh.faces.size() + state.active.size() <= max_triangles && level < deepest_level) continue;
    mesh.stopped = true;
    finish_early(state, decided);
  }
}

/// Halves the sides that turn faces over, for all the faces on them. False when there are none.
/// @param unchecked the first final face that has not been looked at; what stays as it is does not turn over later
bool split_flipped_faces(LevelState& state, std::size_t& unchecked) {
  RefinedMesh& mesh = state.mesh;
  const std::vector<std::uint32_t> sides = sides_of_flipped_faces(mesh, unchecked, state.oracle.orientation(), state.oracle.options().turned_thickness);
  EdgeSplits splits;
  for (const std::uint32_t e : sides)
    if (const std::optional<MappedPoint> middle = state.oracle.middle(mesh.points[mesh.edges[e].a], mesh.points[mesh.edges[e].b]))
      splits.emplace_back(e, *middle);
  if (splits.empty()) return false;
  wake_whole_faces(state, sides);
  mesh.evaluations += splits.size();
  halve_edges(state, {splits});
  const auto is_whole = [&](const RefinedFace& face) {
    return std::none_of(face.edge.begin(), face.edge.end(), [&](std::uint32_t e) { return is_split(mesh, e); });
  };
  const auto touched = std::stable_partition(mesh.faces.begin(), mesh.faces.end(), is_whole);
  state.active.assign(touched, mesh.faces.end());
  mesh.faces.erase(touched, mesh.faces.end());
  unchecked = mesh.faces.size();
  split_faces(state);
  return true;
}

} // namespace

RefinedMesh refine_levels(const Soup& soup, const EdgeOracle& oracle, const LevelOptions& options) {
  LevelState state = start_levels(soup, oracle, options);
  settle(state, 0, options.max_triangles);
  std::size_t unchecked = 0;
  for (int round = 0; round < most_unflipping_rounds && !state.mesh.stopped; ++round) {
    const std::size_t first_new = state.mesh.edges.size();
    if (!split_flipped_faces(state, unchecked)) break;
    settle(state, first_new, options.max_triangles);
  }
  return std::move(state.mesh);
}

} // namespace domewarp
