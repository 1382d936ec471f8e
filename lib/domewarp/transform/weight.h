// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/profile/surface.h"

namespace domewarp {

/// g for the slope R' of a branch whose mean slope is `mean`; positive, finite even where R' is 0 or infinite.
double weight(double slope, double mean);

/// The slope that `weight` calls 1: (radius_high - radius_low) / (theta_high - theta_low), without sign. Infinite, which
/// makes g constant, for a branch with a fold or a kink: beside them g would turn or jump faster than w may bend
/// (one scene on Figure 21b's curve took 45 million triangles to follow it).
double mean_slope(const Surface& surface, std::size_t branch);

/// g, g', g'' in theta, within the smooth stretch of the branch that contains theta.
Vec3 weight_jet(const Surface& surface, std::size_t branch, double theta);

} // namespace domewarp
