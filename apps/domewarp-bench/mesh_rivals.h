// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "benches.h"

namespace domewarp::bench {

/// Triangles of adaptive refinement against the thesis' recursion by edge length and against cutting every triangle
/// alike, at equal measured error.
Table compare_with_rivals(const Options& options);

} // namespace domewarp::bench
