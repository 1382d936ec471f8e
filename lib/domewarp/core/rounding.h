// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace domewarp {

/// The least float that is not below `value`; infinity for what is not a number, so that no bound is lost.
inline float rounded_up(double value) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  if (std::isnan(value)) return infinity;
  const float f = static_cast<float>(value);
  if (static_cast<double>(f) >= value) return f;
  const auto bits = std::bit_cast<std::uint32_t>(f); // +0 or a number other than -0, so the next float has the next bits
  return std::bit_cast<float>(f < 0 ? bits - 1 : bits + 1);
}

} // namespace domewarp
