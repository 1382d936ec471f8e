// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "domewarp/convert/convert.h"
#include "domewarp/core/vectors.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"
#include "domewarp/transform/batch.h"

/// Live use: a scene is prepared once; for each frame its vertices are warped anew for where the eye is now, into
/// buffers of the caller. No file is touched, nothing is allocated that grows with the scene.
///
///     LiveMesh mesh = make_live_mesh(scene);                    // or of a refined scene, see below
///     const BatchMap map(display.surface);                      // once per surface
///     std::vector<Vec3f> positions(mesh.positions.size());      // or a mapped vertex buffer
///     rewarp(mesh, view, map, BatchOutput::perspective, positions); // every frame
///
/// Triangles, texture coordinates and materials stay those of the scene. What the fast path cannot do is to split
/// triangles where the new view needs it: `convert` with a `Display` that is kept does that, at its own pace.
namespace domewarp {

/// The vertices of one primitive of one instance.
struct LivePart {
  int instance = 0;              ///< index into Scene::instances
  int primitive = 0;             ///< index into the primitives of its mesh
  std::size_t first = 0;         ///< its first vertex within the buffers
  std::size_t count = 0;
  Mat4 world = Mat4(1);          ///< to world space; change it between frames and the part moves
};

/// The vertices of a scene one after another: instances in their order, the primitives of each in theirs.
struct LiveMesh {
  std::vector<LivePart> parts;   ///< in the order of `first`; together they cover all positions
  std::vector<Vec3f> positions;  ///< n, each in the space of its part
};

/// All vertices of a scene as it was read; where its triangles are large their insides are as wrong as they would be with
/// `--subdivide none`.
LiveMesh make_live_mesh(const Scene& scene);

/// The vertices of a scene that `convert` has refined with `RefineOptions::source_attributes`, as they lay in the world.
/// Within the tolerance at the view of the report, and near it: what was out of sight then is missing, so leave the
/// display a margin and refine again when the eye has gone far.
/// @param report what `convert` said about `warped`
/// @throws Error(usage) when a vertex does not say where it came from, or the surface has several branches
LiveMesh make_live_mesh(const Scene& warped, const ConvertReport& report);

/// Where the vertices appear for an eye at `view`, all cores at work: eye space in double precision, then `map`.
/// @param output perspective: w (x', y', -1), to be drawn by a perspective camera of 90 degrees (see BatchMap on w);
///               image: x', y', distance from the eye
/// @param out as many as mesh.positions; written in their order
/// @throws Error(usage) when `out` has another size
void rewarp(const LiveMesh& mesh, const View& view, const BatchMap& map, BatchOutput output, std::span<Vec3f> out);

} // namespace domewarp
