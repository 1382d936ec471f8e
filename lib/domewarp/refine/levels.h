// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "domewarp/refine/edge_oracle.h"
#include "domewarp/refine/picture_cull.h"
#include "domewarp/refine/soup.h"

namespace domewarp {

/// An edge of the refined mesh; `a` precedes `b`.
struct RefinedEdge {
  static constexpr std::uint32_t none = 0xffffffff;
  std::uint32_t a = 0, b = 0;
  std::uint32_t middle = none;   ///< the point that splits it
  std::uint32_t child = 0;       ///< its halves: child (with a) and child + 1 (with b)
  std::uint32_t source = none;   ///< the edge of the soup it is part of, none inside a source face
  float error = 0, depth_error = 0;
  float middle_error = -1;       ///< see EdgeDecision
  float arch = 0;                ///< see EdgeDecision
  bool certified = true;         ///< see EdgeDecision
};

struct RefinedFace {
  Triangle point, wedge, edge;   ///< edge[k] joins corners k and k + 1
  std::uint32_t source = 0;      ///< index into Soup::faces
  std::uint8_t insertions = 0;   ///< how many centroids were inserted on the way to it
};

/// One branch of the surface, refined and clipped.
struct RefinedMesh {
  std::vector<MappedPoint> points;
  std::vector<RefinedEdge> edges;
  std::vector<Wedge> wedges;     ///< those made here; their ids follow the soup's
  std::vector<RefinedFace> faces; ///< final and visible, in the order of the source
  std::size_t clipped = 0;
  std::size_t off_picture = 0;   ///< pieces dropped before they were refined, as far outside the picture's rectangle
  std::size_t uncertified_faces = 0; ///< judged by samples
  std::size_t evaluations = 0;
  std::size_t levels = 0;
  bool stopped = false;          ///< by the limit on triangles
};

/// Refines level by level until no edge asks for a split. Deterministic for any number of threads.
/// @param cull drops what the picture does not show, before it is refined; null: nothing is dropped
RefinedMesh refine_levels(const Soup& soup, const EdgeOracle& oracle, std::size_t max_triangles, const PictureCull* cull = nullptr);

} // namespace domewarp
