// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/gltf/write.h"
#include "domewarp/refine/refine.h"
#include "domewarp/scene/raster.h"

namespace domewarp {

/// How far writing with `write` moves a vertex of a warped scene in the picture at most, pixels: positions move by up to
/// |d| = sqrt(3) packing_error, and x = X / -Z by |d| sqrt(1 + |x|^2) / (|Z| - |d|). Infinite where a vertex may reach the
/// camera. 0 without compression that rounds.
double packing_error_px(const Scene& warped, const WriteOptions& write, Projection projection, const Raster& raster);

} // namespace domewarp
