// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "domewarp/profile/quad.h"

namespace domewarp {

/// A function's value and slope at one point; T is double or Quad.
template <typename T>
struct ValueAndSlope {
  T value = 0, slope = 0;
};

/// Half way between 0 <= lo < hi, in the exponent where the two are of different size.
template <typename T>
T middle_of(const T& lo, const T& hi) {
  using std::sqrt;
  if (hi > 64 * lo) return lo > 0 ? sqrt(lo) * sqrt(hi) : hi / 64;
  return lo + 0.5 * (hi - lo);
}

/// Newton's steps smaller than this, relative to the root, end the search: rounding for double; for Quad, whose roots
/// are rounded to double in the end, more would be lost labour.
template <typename T>
inline constexpr double root_resolution = 1e-18;
template <>
inline constexpr double root_resolution<double> = 2.3e-16;

/// The root of f in [lo, hi], 0 <= lo < hi: Newton's steps, halving the bracket whenever they leave it or stop
/// converging, so that no function takes for ever. Ends where rounding stops progress, or where the last two steps say
/// that the next would be far below it: they shrink like squares.
/// @param sign_at_lo +1 or -1, the sign of f at lo; that at hi is the opposite. @param guess where to start.
template <typename Function, typename T>
T find_root(const Function& f, T lo, T hi, const T& guess, double sign_at_lo) {
  using std::abs;
  T x = guess > lo && guess < hi ? guess : middle_of(lo, hi);
  T step = hi - lo, before = 0; // before: the length of Newton's step before, 0 where it was none
  for (int i = 0; i < 400; ++i) {
    const auto [value, slope] = f(x);
    if (value == 0) return x;
    (value * sign_at_lo > 0 ? lo : hi) = x;
    T next = x - value / slope;
    const bool converges = next >= lo && next <= hi && abs(next - x) <= 0.5 * abs(step);
    if (!converges) {
      next = middle_of(lo, hi);
      if (next <= lo || next >= hi) return x;
    }
    step = next - x;
    x = next;
    const T length = abs(step), resolution = root_resolution<T> * abs(x);
    if (length <= resolution) return x;
    const bool shrinks = converges && length < 1e-3 * before;
    if (shrinks && length * (length / before) * (length / before) <= 1e-3 * resolution) return x;
    before = converges ? length : T(0);
  }
  return x;
}

} // namespace domewarp
