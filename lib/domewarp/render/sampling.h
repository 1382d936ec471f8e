// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "domewarp/core/vectors.h"

namespace domewarp {

/// Point `index` of an Owen-scrambled Sobol sequence in [0, 1)^2. Of the first 2^k points, one lies in every dyadic
/// rectangle of area 2^-k. `seed` chooses the scrambling; seeds that differ give sequences that are unrelated.
Vec2 sobol_point(std::uint32_t index, std::uint32_t seed);

/// A seed for every pixel of a picture, the same on every run.
std::uint32_t pixel_seed(int column, int row);

} // namespace domewarp
