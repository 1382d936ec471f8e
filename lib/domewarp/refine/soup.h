// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/core/raw_vector.h"
#include "domewarp/mesh/topology.h"
#include "domewarp/refine/view_cull.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"

namespace domewarp {

/// One primitive of one instance: the unit that keeps its material and attributes.
struct SoupPart {
  int instance = 0;
  int primitive = 0;            ///< within the instance's mesh
  std::uint32_t first_wedge = 0; ///< wedge of the primitive's vertex 0
};

/// A face corner's attributes: a vertex of the source, or a blend of three earlier wedges of the same part.
struct Wedge {
  std::array<std::uint32_t, 3> parent{};
  std::array<double, 3> weight{1, 0, 0};
  std::uint32_t point = 0;
  std::uint32_t part = 0;
};

struct SoupFace {
  Triangle wedge;               ///< counter-clockwise, into Soup::wedge_point; points_of() are all different
  std::uint32_t part = 0;
};

/// Every triangle of a scene in eye space, welded: points are shared across seams, primitives, meshes and nodes.
struct Soup {
  std::vector<SoupPart> parts;
  std::vector<Vec3> points;
  std::vector<std::uint32_t> wedge_point; ///< per wedge: source vertices first, then extra_wedges
  std::size_t source_wedges = 0;          ///< how many of these are source vertices
  std::vector<Wedge> extra_wedges;        ///< made where T-junctions were split
  RawVector<SoupFace> faces;
  std::size_t source_triangles = 0;
  std::size_t degenerate_triangles = 0;   ///< two corners at one position: dropped, they cover nothing
  std::size_t outside_view = 0;           ///< of primitives that cannot be seen: dropped before anything was transformed
  std::size_t back_faces = 0;             ///< dropped: single-sided and seen from behind
  std::size_t snapped = 0;                ///< points that SoupOptions::weld moved
  std::size_t near_misses = 0;            ///< pairs of ends of open edges that differ by a few float32 roundings
  std::size_t open_edges = 0;             ///< of the source, T-junctions split
  std::size_t t_junctions = 0;            ///< split, so that the warp does not open them
};

/// The corners of a face, into Soup::points.
inline Triangle points_of(const Soup& soup, const SoupFace& face) {
  return {soup.wedge_point[face.wedge[0]], soup.wedge_point[face.wedge[1]], soup.wedge_point[face.wedge[2]]};
}

struct SoupOptions {
  bool cull_back_faces = true;
  double weld = 0;                        ///< points that are this near are joined, scene units; 0: equal to the bit
  const ViewCull* view_cull = nullptr;    ///< null: every primitive enters
};

/// Deterministic; order of faces and wedges follows the scene.
Soup make_soup(const Scene& scene, const View& view, const SoupOptions& options);

/// The triangles as the file lists them: every vertex is a point of its own, nothing is welded, mended or culled, and
/// there is no topology.
Soup make_loose_soup(const Scene& scene, const View& view);

} // namespace domewarp
