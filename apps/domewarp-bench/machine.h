// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace domewarp::bench {

/// CPU, instruction set, number of cores and compiler in one line.
std::string machine();

} // namespace domewarp::bench
