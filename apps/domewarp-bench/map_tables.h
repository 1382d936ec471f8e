// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "benches.h"

namespace domewarp::bench {

/// The curves of the founding thesis, one with a kink, one with a vertical tangent inside, one that folds at the rim.
const std::vector<std::string>& map_curves();

/// The float table of every curve at the corners of a square and of a 4:3 picture: size, predicted and measured error.
Table float_tables(const Options& options);

/// The double-precision table of every curve: size, error, time to build, and from how many points on that time is won back.
Table double_tables(const Options& options);

} // namespace domewarp::bench
