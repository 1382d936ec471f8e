// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "domewarp/transform/batch.h"

namespace domewarp::bench {

/// What any such map does at least with every point: reads it, takes the two roots (distance from the axis and from the
/// eye) and one division, writes three numbers. On the instruction set that Highway chose, in the layout of three arrays.
void map_floor(const ConstPoints& in, const Points& out, std::size_t count);

} // namespace domewarp::bench
