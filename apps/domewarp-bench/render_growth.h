// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "benches.h"

namespace domewarp::bench {

/// Time and memory of both renderers against the pixels of the picture. Starts processes: to be called before anything
/// starts threads.
void measure_pixels(const Options& options, Result& result);

} // namespace domewarp::bench
