// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace domewarp {

/// A function's value and slope at one point.
struct ValueAndSlope {
  double value = 0, slope = 0;
};

/// Half way between 0 <= lo < hi, in the exponent where the two are of different size.
inline double middle_of(double lo, double hi) {
  if (hi > 64 * lo) return lo > 0 ? std::sqrt(lo) * std::sqrt(hi) : hi / 64;
  return lo + 0.5 * (hi - lo);
}

/// The root of f in [lo, hi], 0 <= lo < hi: Newton's steps, halving the bracket whenever they leave it or stop
/// converging, so that no function takes for ever. Ends where rounding stops progress.
/// @param sign_at_lo +1 or -1, the sign of f at lo; that at hi is the opposite. @param guess where to start.
template <typename Function>
double find_root(const Function& f, double lo, double hi, double guess, double sign_at_lo) {
  double x = guess > lo && guess < hi ? guess : middle_of(lo, hi);
  double step = hi - lo;
  for (int i = 0; i < 400; ++i) {
    const auto [value, slope] = f(x);
    if (value == 0) return x;
    (value * sign_at_lo > 0 ? lo : hi) = x;
    double next = x - value / slope;
    const bool converges = next >= lo && next <= hi && std::abs(next - x) <= 0.5 * std::abs(step);
    if (!converges) {
      next = middle_of(lo, hi);
      if (next <= lo || next >= hi) return x;
    }
    step = next - x;
    x = next;
    if (std::abs(step) <= 2.3e-16 * std::abs(x)) return x;
  }
  return x;
}

} // namespace domewarp
