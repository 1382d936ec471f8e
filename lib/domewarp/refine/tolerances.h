// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/refine/edge_oracle.h"
#include "domewarp/refine/refine.h"

namespace domewarp {

/// What the options ask of edges and faces, in image units, less what the rounding of the file may add.
OracleOptions oracle_options(const RefineOptions& options, const Raster& raster);

} // namespace domewarp
