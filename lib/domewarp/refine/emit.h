// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "domewarp/refine/levels.h"
#include "domewarp/refine/refine.h"

namespace domewarp {

/// Appends one refined branch to `out`: primitives with warped float positions and interpolated attributes, on the
/// mesh of their instance (out.meshes[i] belongs to scene.instances[i]), faces in the order of the source. Those outside
/// the picture, hidden, or of coinciding corners are dropped.
/// @param orientation of the branch: -1 reverses the winding
void emit(const Scene& scene, const View& view, const Soup& soup, const RefinedMesh& refined, int orientation,
          const Raster& raster, const RefineOptions& options, Scene& out, RefineReport& report);

/// Adds what the finished edges of one branch tell: certified errors, and edges within the picture that are open without
/// a reason.
void audit_edges(const RefinedMesh& refined, const EdgeOracle& oracle, const Raster& raster, const RefineOptions& options, RefineReport& report);

/// Adds certified errors (image units; reordered) to the report: the largest of every branch and kind counts.
void add_errors(std::vector<float>& errors, const Raster& raster, RefineReport& report);

/// The camera that shows the picture, from the depths that were written.
Camera picture_camera(const Raster& raster, Projection projection, double smallest_depth, double largest_depth);

} // namespace domewarp
