// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "domewarp/refine/warped_vertex.h"
#include "domewarp/refine/wedge_values.h"

namespace domewarp {

/// A face that is drawn: of the soup as it is where this bit is set, of the refined mesh otherwise.
using DrawnFace = std::uint32_t;
inline constexpr DrawnFace whole_bit = 0x80000000;

/// The corners of a drawn face.
struct DrawnCorners {
  Triangle point;
  const Triangle& wedge;
  std::uint32_t source; ///< face of the soup
};
inline DrawnCorners corners_of(const Soup& soup, const RefinedMesh& refined, DrawnFace face) {
  if (face & whole_bit) return {points_of(soup, soup.faces[face & ~whole_bit]), soup.faces[face & ~whole_bit].wedge, face & ~whole_bit};
  return {refined.faces[face].point, refined.faces[face].wedge, refined.faces[face].source};
}

/// Everything that the parts of one branch are emitted from.
struct EmitJob {
  const Scene& scene;
  const View& view;
  const Soup& soup;
  const RefinedMesh& refined;
  const RefineOptions& options;
  const WedgeValues& values;
  const std::vector<std::uint8_t>& drawn; ///< per wedge: whether a written face uses it
  int orientation;
  std::vector<std::uint32_t>& vertex_of;  ///< per wedge: scratch of the part it belongs to
};

struct PartOutput {
  Primitive primitive;
  double smallest_depth = std::numeric_limits<double>::infinity(), largest_depth = 0;
};

/// One part of the output. Vertices stand in the order of the source, those made by refinement after them.
PartOutput emit_part(const EmitJob& job, std::uint32_t part, std::span<const DrawnFace> faces);

} // namespace domewarp
