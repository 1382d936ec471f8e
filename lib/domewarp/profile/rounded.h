// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "domewarp/profile/jet.h"

namespace domewarp {

/// A double with a bound of what rounding has made of it since the last exact number: a running error analysis, some
/// twenty times as fast as an interval. Elementary functions are taken to be within 2 ulp. Infinite or nan where the
/// bound of the derivative would not hold over so wide an error.
struct Rounded {
  double v = 0, e = 0;
};

namespace rounded_rules {

inline constexpr double ulp = 2.3e-16; // a little more than the spacing of doubles

/// Functions whose slope moves by less than `share` over the error: the bound of the slope holds with this to spare.
inline constexpr double share = 1e-3, spare = 1.01;

inline Rounded rounded(double v, double e) { return {v, e + 0.5 * ulp * std::abs(v)}; }
/// @param e error handed on by the slope. @param relative of the slope over the argument's error
inline Rounded function(double v, double e, double relative) {
  return {v, relative <= share ? spare * e + 2 * ulp * std::abs(v) : std::numeric_limits<double>::infinity()};
}

} // namespace rounded_rules

inline Rounded operator-(const Rounded& a) { return {-a.v, a.e}; }
inline Rounded operator+(const Rounded& a, const Rounded& b) { return rounded_rules::rounded(a.v + b.v, a.e + b.e); }
inline Rounded operator-(const Rounded& a, const Rounded& b) { return rounded_rules::rounded(a.v - b.v, a.e + b.e); }
inline Rounded operator*(const Rounded& a, const Rounded& b) {
  return rounded_rules::rounded(a.v * b.v, std::abs(a.v) * b.e + (std::abs(b.v) + b.e) * a.e);
}
inline Rounded operator/(const Rounded& a, const Rounded& b) {
  const double v = a.v / b.v, least = std::abs(b.v) - b.e;
  return rounded_rules::rounded(v, least > 0 ? (a.e + std::abs(v) * b.e) / least : std::numeric_limits<double>::infinity());
}

inline Rounded abs(const Rounded& a) { return {std::abs(a.v), a.e}; }
inline Rounded max(const Rounded& a, const Rounded& b) {
  const double v = std::isnan(a.v) || std::isnan(b.v) ? a.v + b.v : std::max(a.v, b.v);
  return {v, std::max(a.e, b.e)};
}

/// u^n; relative to v the slope is n / u and its own slope (n - 1) / u.
inline Rounded power(const Rounded& u, double n) {
  const double v = power(u.v, n);
  if (u.e == 0) return rounded_rules::function(v, 0, 0);
  return rounded_rules::function(v, std::abs(v * n / u.v) * u.e, std::abs((n - 1) / u.v) * u.e);
}
inline Rounded power(const Rounded& u, int n) {
  const double v = power(u.v, n);
  if (u.e == 0) return rounded_rules::function(v, 0, 0);
  return rounded_rules::function(v, std::abs(v * n / u.v) * u.e, std::abs((n - 1) / u.v) * u.e);
}
inline Rounded power(const Rounded& a, const Rounded& b) {
  const double v = power(a.v, b.v), size = std::abs(std::log(a.v));
  const double e = std::abs(b.v / a.v) * a.e + size * b.e; // of the logarithm
  return rounded_rules::function(v, std::abs(v) * e, e + a.e / std::abs(a.v));
}

inline Rounded sqrt(const Rounded& u) {
  const double v = std::sqrt(u.v);
  if (u.e == 0) return rounded_rules::rounded(v, 0);
  return rounded_rules::function(v, 0.5 * u.e / v, u.e / u.v);
}
inline Rounded exp(const Rounded& u) {
  const double v = std::exp(u.v);
  return rounded_rules::function(v, v * u.e, u.e);
}
inline Rounded log(const Rounded& u) { return rounded_rules::function(std::log(u.v), u.e / u.v, u.e / u.v); }
inline Rounded log10(const Rounded& u) { return rounded_rules::function(std::log10(u.v), 0.5 * u.e / u.v, u.e / u.v); }
inline Rounded sin(const Rounded& u) { return rounded_rules::function(std::sin(u.v), u.e, 0); }
inline Rounded cos(const Rounded& u) { return rounded_rules::function(std::cos(u.v), u.e, 0); }
inline Rounded tan(const Rounded& u) {
  const double v = std::tan(u.v), slope = 1 + v * v;
  return rounded_rules::function(v, slope * u.e, 2 * std::abs(v) * u.e);
}
inline Rounded cot(const Rounded& u) {
  const double v = cot(u.v), slope = 1 + v * v;
  const Rounded cotangent = rounded_rules::function(v, slope * u.e, 2 * std::abs(v) * u.e);
  return rounded_rules::rounded(v, cotangent.e); // one division more
}
inline Rounded asin(const Rounded& u) {
  const double room = (1 - u.v) * (1 + u.v);
  return rounded_rules::function(std::asin(u.v), u.e == 0 ? 0 : u.e / std::sqrt(room), u.e == 0 ? 0 : u.e / room);
}
inline Rounded acos(const Rounded& u) { return {std::acos(u.v), asin(u).e + rounded_rules::ulp * 4}; }
inline Rounded atan(const Rounded& u) { return rounded_rules::function(std::atan(u.v), u.e, 0); }
inline Rounded sinh(const Rounded& u) {
  const double v = std::sinh(u.v);
  return rounded_rules::function(v, (1 + std::abs(v)) * u.e, u.e);
}
inline Rounded cosh(const Rounded& u) {
  const double v = std::cosh(u.v);
  return rounded_rules::function(v, v * u.e, u.e);
}
inline Rounded tanh(const Rounded& u) { return rounded_rules::function(std::tanh(u.v), u.e, 0); }

} // namespace domewarp
