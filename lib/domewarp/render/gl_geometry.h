// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/render/parts.h"

namespace domewarp {

/// A vertex as the shaders read it (gl_shaders.h).
struct GlVertex {
  float position[3];
  float source[4];
  float normal[3];
  float colour[4];
  float uv[4];
};

struct GlTriangle {
  std::uint32_t corners[3];
};

struct GlIds {
  std::uint32_t object, triangle;
};

/// Consecutive triangles that are drawn with the same state.
struct GlBatch {
  const Look* look = nullptr;
  std::size_t first = 0, count = 0; ///< triangles
};

/// Points or lines of one primitive.
struct GlStrokes {
  const Look* look = nullptr;
  Topology topology = Topology::lines;
  std::size_t first = 0, count = 0; ///< in GlGeometry::strokes
};

/// Everything that is drawn, in drawing order: first opaque and masked triangles in the scene's order, then points and
/// lines, then the blended triangles, farthest first.
struct GlGeometry {
  std::vector<GlVertex> vertices;
  std::vector<GlTriangle> triangles;
  std::vector<GlIds> ids; ///< by triangle
  std::vector<GlBatch> opaque, blended;
  std::vector<std::uint32_t> strokes; ///< vertices, one per point and two per line
  std::vector<GlStrokes> stroke_batches;
};

/// @param camera_from_world turns world positions into camera space; done in double precision, rounded once
/// Triangles with a corner that is not finite are left out.
/// @throws Error(input) when there are more than 2^32 vertices
GlGeometry make_gl_geometry(const Parts& parts, const Mat4& camera_from_world);

} // namespace domewarp
