// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "benches.h"

namespace domewarp::bench {

/// Time and memory of refinement from 10^4 triangles up, each size in a process of its own (call it before anything
/// starts threads), with the slopes of the log-log fits as notes.
void measure_growth(const Options& options, Result& result);

/// The five scenes with everything skipped that can be, and with each kind of skipping left out in turn.
Table measure_skips(const Options& options);

} // namespace domewarp::bench
