// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/gltf/write.h"
#include "domewarp/refine/refine.h"
#include "domewarp/scene/raster.h"

namespace domewarp {

struct PackedFlips {
  std::size_t found = 0; ///< triangles that rounding to the grid of the file would turn over
  std::size_t left = 0;  ///< of these, still turned
  double moved_px = 0;   ///< how far a vertex moved at most, rounding included; 0 when none was moved
};

/// Turns back what rounding to the file's grid turns over: triangles thinner than a step of it. One of their vertices goes
/// to another point of the grid, at most three steps off, where fewer triangles around it are turned; vertices at one
/// position go together, so nothing tears, and no triangle is lost. Does nothing where the file has no grid.
/// @param warped needs _SOURCE_POSITION (eye space), which tells how each triangle must turn. The result depends on
///        positions alone, whatever the order of triangles.
/// @param write gets the grid, which the moved positions must be written to
PackedFlips mend_packed_flips(Scene& warped, WriteOptions& write, Projection projection, const Raster& raster);

} // namespace domewarp
