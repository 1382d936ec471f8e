// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to refinement: what one level leaves for the next.
// Work is cut into blocks of fixed size whose results are joined in order, so the number of threads cannot show.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "domewarp/refine/levels.h"

namespace domewarp {

inline constexpr std::size_t level_block = 2048;
inline std::size_t level_blocks(std::size_t items) { return (items + level_block - 1) / level_block; }

/// Edges to split and their points, in the order of the edges.
using EdgeSplits = std::vector<std::pair<std::uint32_t, MappedPoint>>;

struct LevelState {
  const Soup& soup;
  const EdgeOracle& oracle;
  const PictureCull* cull;
  std::span<const std::uint8_t> plain_faces; ///< see LevelOptions
  RefinedMesh mesh{};
  EdgeSplits wanted{};                ///< edges that must be split and are not yet
  RawVector<RefinedFace> active{};  ///< neither final nor dropped
  std::uint32_t first_wedge = 0;      ///< id of mesh.wedges[0]
  std::uint32_t first_middle = 0;     ///< point id of the first middle of the edges that this level splits; they come in a row
};

/// Locates the soup's points, sifts its faces and builds the edges of those that must be refined.
LevelState start_levels(const Soup& soup, const EdgeOracle& oracle, const LevelOptions& options);

/// The edge of the refined mesh that joins two points. @param source,inner see RefinedEdge
RefinedEdge edge_of(std::span<const MappedPoint> points, std::uint32_t p, std::uint32_t q, std::uint32_t source, bool inner = false);

/// What holds inside a face of the soup, if that differs from what holds on its outline.
std::optional<InnerPlane> inner_plane(const LevelState& state, std::uint32_t face);

/// Gives the edges of all blocks their middles and halves.
void halve_edges(LevelState& state, const std::vector<EdgeSplits>& blocks);

/// Writes down what was decided.
void note(const EdgeDecision& decision, RefinedEdge& edge);

/// Decides about all edges from `first` on; those that must be split join the wanted ones. @return the first undecided edge
std::size_t decide_edges(LevelState& state, std::size_t first);

/// Gives the two faces of a wanted inner edge their other diagonal where that is good, or much less bad.
void swap_edges(LevelState& state);

/// The wanted edges that are split now: all but inner ones beside a face that has another to split, a longer one or no inner
/// one. They may never need it: others are made, and tried as their other diagonal, in the meantime.
EdgeSplits choose_splits(LevelState& state);

/// Per active face the wedges at the middles of its split sides: one for all faces that have the same wedges at the side's ends.
std::vector<Triangle> add_middle_wedges(LevelState& state);

/// Replaces the active faces by what their split sides make of them; faces without a split side are finished.
void split_faces(LevelState& state);

/// The first boundary that a face without split sides lies outside of, or -1 when it is visible.
int hiding_boundary(const LevelState& state, const RefinedFace& face);

/// Makes whole faces active that have a side among those to be split. @param sides edges of state.mesh.edges
void wake_whole_faces(LevelState& state, const std::vector<std::uint32_t>& sides);

inline const MappedPoint& corner_of(const RefinedMesh& mesh, const RefinedFace& face, int k) { return mesh.points[face.point[k]]; }

inline bool is_split(const RefinedMesh& mesh, std::uint32_t edge) { return mesh.edges[edge].middle != RefinedEdge::none; }

} // namespace domewarp
