// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/profile/surface.h"

namespace domewarp {

/// g for the slope R' of a branch whose mean slope is `mean`; positive, finite even where R' is 0 or infinite.
double weight(double slope, double mean);

/// (radius_high - radius_low) / (theta_high - theta_low), without sign.
double mean_slope(const Branch& branch);

/// g, g', g'' in theta, within the smooth stretch of the branch that contains theta.
Vec3 weight_jet(const Surface& surface, std::size_t branch, double theta);

} // namespace domewarp
