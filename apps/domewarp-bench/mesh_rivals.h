// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "benches.h"

namespace domewarp::bench {

/// Triangles of adaptive refinement against the thesis' recursion by edge length and against cutting every triangle
/// alike, at equal measured error.
Table compare_with_rivals(const Options& options);

/// Triangles and time of the same against the error, from 4 to 0.05 px, on the box, beside the lower bound N*.
Table sweep_tolerances(const Options& options);

} // namespace domewarp::bench
