// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "domewarp/core/raw_vector.h"
#include "domewarp/refine/edge_oracle.h"
#include "domewarp/refine/soup.h"

namespace domewarp {

/// An edge of the refined mesh; `a` precedes `b`.
struct RefinedEdge {
  static constexpr std::uint32_t none = 0xffffffff;
  std::uint32_t a = 0, b = 0;
  std::uint32_t middle = none;   ///< the point that splits it
  std::uint32_t child = 0;       ///< its halves: child (with a) and child + 1 (with b)
  std::uint32_t source = none;   ///< the source edge it is part of (into source_edges); of an inner edge the face of the soup it is inside of
  float error = 0, depth_error = 0;
  float second = -1;             ///< until it is decided: EdgeBend::second with the other in depth_error, where known
  float middle_error = -1;       ///< see EdgeDecision
  float excess = 0;              ///< see EdgeDecision
  float arch = 0;                ///< see EdgeDecision
  bool certified = true;         ///< see EdgeDecision
  bool slides = false;           ///< see EdgeDecision
  bool inner = false;            ///< inside one face of the source
  bool wanted = false;           ///< it must be split but is not yet; `child` is then its place among those (LevelState::wanted)
  std::uint8_t waited = 0;       ///< levels that it has been so
  bool swapped = false;          ///< it took the place of another edge
};

struct RefinedFace {
  Triangle point, wedge, edge;   ///< edge[k] joins corners k and k + 1
  std::uint32_t source = 0;      ///< index into Soup::faces
  std::uint8_t insertions = 0;   ///< how many centroids were inserted on the way to it
  bool is_new = true;            ///< made since the last look for other edges
};

/// A face of the soup that is drawn as it is and has no edges in the refined mesh.
struct WholeFace {
  std::uint32_t source = 0;      ///< index into Soup::faces
  float error = 0;               ///< bounds each of its sides, image units
};

/// An edge of the soup that refined faces are on.
struct SourceEdge {
  std::uint32_t faces = 0;       ///< of the soup on it
  std::uint32_t whole = 0;       ///< of these, drawn as they are
};

/// One branch of the surface, refined and clipped.
struct RefinedMesh {
  RawVector<MappedPoint> points; ///< those of the soup first
  std::size_t source_points = 0;   ///< how many these are
  RawVector<RefinedEdge> edges;
  std::vector<SourceEdge> source_edges;
  RawVector<Wedge> wedges;     ///< those made here; their ids follow the soup's
  std::vector<std::size_t> wedge_groups; ///< ends of runs of wedges whose parents stand before the run; may be empty
  RawVector<RefinedFace> faces; ///< final and visible
  std::vector<WholeFace> whole;  ///< in the order of the soup
  float slide_depth_error = 0;   ///< bounds the edges that slide, relative
  float whole_depth_error = 0;   ///< bounds them all, relative
  double face_depth_error = 0;   ///< bounds the interiors of `faces`, relative
  std::size_t clipped = 0;
  std::size_t off_picture = 0;   ///< pieces dropped before they were refined, as far outside the picture's rectangle
  std::size_t uncertified_faces = 0; ///< judged by samples
  std::size_t evaluations = 0;
  std::size_t levels = 0;
  bool stopped = false;          ///< by the limit on triangles
};

/// Whether an edge is a whole one of the source.
inline bool is_whole_source_edge(const RefinedMesh& mesh, const RefinedEdge& edge) {
  return !edge.inner && std::max(edge.a, edge.b) < mesh.source_points;
}

} // namespace domewarp
