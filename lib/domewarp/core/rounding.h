// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

namespace domewarp {

/// The least float that is not below `value`; infinity for what is not a number, so that no bound is lost.
inline float rounded_up(double value) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  if (std::isnan(value)) return infinity;
  const float f = static_cast<float>(value);
  return static_cast<double>(f) >= value ? f : std::nextafter(f, infinity);
}

} // namespace domewarp
