// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

#include "domewarp/profile/interval.h"
#include "domewarp/profile/quad.h"

namespace domewarp {

/// A value with its first and second derivative in r: exact differentiation for T = double and Quad, enclosures of all three
/// for T = Interval (where a function has a kink, of the slopes on either side; the second derivative is then
/// unbounded).
template <typename T>
struct Jet {
  T v{}, d{}, dd{};
};

/// The real counterparts of interval functions that <cmath> lacks.
inline double cot(double x) { return 1 / std::tan(x); }
inline double power(double x, double exponent) {
  return x < 0 ? std::numeric_limits<double>::quiet_NaN() : std::pow(x, exponent);
}
double power(double x, int exponent);

namespace jet_rules {

/// Zero wins over infinity: a constant stays constant under functions of infinite slope.
inline double times(double a, double b) { return a == 0 || b == 0 ? 0 : a * b; }
inline Quad times(const Quad& a, const Quad& b) { return a == 0 || b == 0 ? Quad(0) : a * b; }
inline Interval times(const Interval& a, const Interval& b) { return a * b; }
inline double square(double a) { return a * a; }
inline Quad square(const Quad& a) { return a * a; }
inline Interval square(const Interval& a) { return power(a, 2); }

template <typename T>
Jet<T> chain(const Jet<T>& u, const T& value, const T& first, const T& second) {
  return {value, times(first, u.d), times(second, square(u.d)) + times(first, u.dd)};
}

} // namespace jet_rules

template <typename T>
Jet<T> operator-(const Jet<T>& a) {
  return {-a.v, -a.d, -a.dd};
}
template <typename T>
Jet<T> operator+(const Jet<T>& a, const Jet<T>& b) {
  return {a.v + b.v, a.d + b.d, a.dd + b.dd};
}
template <typename T>
Jet<T> operator-(const Jet<T>& a, const Jet<T>& b) {
  return {a.v - b.v, a.d - b.d, a.dd - b.dd};
}
template <typename T>
Jet<T> operator*(const Jet<T>& a, const Jet<T>& b) {
  using jet_rules::times;
  return {a.v * b.v, times(a.d, b.v) + times(a.v, b.d), times(a.dd, b.v) + T(2) * times(a.d, b.d) + times(a.v, b.dd)};
}
template <typename T>
Jet<T> operator/(const Jet<T>& a, const Jet<T>& b) {
  using jet_rules::times;
  const T v = a.v / b.v;
  const T d = (a.d - times(v, b.d)) / b.v;
  return {v, d, (a.dd - T(2) * times(d, b.d) - times(v, b.dd)) / b.v};
}

template <typename T>
Jet<T> power(const Jet<T>& u, int n) {
  const T first = n == 0 ? T(0) : T(n) * power(u.v, n - 1);
  const T second = n == 0 || n == 1 ? T(0) : T(static_cast<double>(n) * (n - 1)) * power(u.v, n - 2);
  return jet_rules::chain(u, power(u.v, n), first, second);
}
template <typename T>
Jet<T> power(const Jet<T>& u, double n) {
  return jet_rules::chain(u, power(u.v, n), T(n) * power(u.v, n - 1), T(n) * T(n - 1) * power(u.v, n - 2));
}

template <typename T>
Jet<T> sqrt(const Jet<T>& u) {
  using std::sqrt;
  const T v = sqrt(u.v);
  return jet_rules::chain(u, v, T(0.5) / v, T(-0.25) / power(v, 3));
}
template <typename T>
Jet<T> exp(const Jet<T>& u) {
  using std::exp;
  const T v = exp(u.v);
  return jet_rules::chain(u, v, v, v);
}
template <typename T>
Jet<T> log(const Jet<T>& u) {
  using std::log;
  return jet_rules::chain(u, log(u.v), T(1) / u.v, T(-1) / power(u.v, 2));
}
template <typename T>
Jet<T> log10(const Jet<T>& u) {
  using std::log, std::log10;
  const T slope = T(1) / log(T(10));
  return jet_rules::chain(u, log10(u.v), slope / u.v, -slope / power(u.v, 2));
}
template <typename T>
Jet<T> sin(const Jet<T>& u) {
  using std::cos, std::sin;
  const T v = sin(u.v);
  return jet_rules::chain(u, v, cos(u.v), -v);
}
template <typename T>
Jet<T> cos(const Jet<T>& u) {
  using std::cos, std::sin;
  const T v = cos(u.v);
  return jet_rules::chain(u, v, -sin(u.v), -v);
}
template <typename T>
Jet<T> tan(const Jet<T>& u) {
  using std::tan;
  const T v = tan(u.v), first = T(1) + power(v, 2);
  return jet_rules::chain(u, v, first, T(2) * v * first);
}
template <typename T>
Jet<T> cot(const Jet<T>& u) {
  const T v = cot(u.v), first = -(T(1) + power(v, 2));
  return jet_rules::chain(u, v, first, T(-2) * v * first);
}
template <typename T>
Jet<T> asin(const Jet<T>& u) {
  using std::asin, std::sqrt;
  const T first = T(1) / sqrt((T(1) - u.v) * (T(1) + u.v));
  return jet_rules::chain(u, asin(u.v), first, u.v * power(first, 3));
}
template <typename T>
Jet<T> acos(const Jet<T>& u) {
  using std::acos;
  Jet<T> result = -asin(u);
  result.v = acos(u.v);
  return result;
}
template <typename T>
Jet<T> atan(const Jet<T>& u) {
  using std::atan;
  const T first = T(1) / (T(1) + power(u.v, 2));
  return jet_rules::chain(u, atan(u.v), first, T(-2) * u.v * power(first, 2));
}
template <typename T>
Jet<T> sinh(const Jet<T>& u) {
  using std::cosh, std::sinh;
  const T v = sinh(u.v);
  return jet_rules::chain(u, v, cosh(u.v), v);
}
template <typename T>
Jet<T> cosh(const Jet<T>& u) {
  using std::cosh, std::sinh;
  const T v = cosh(u.v);
  return jet_rules::chain(u, v, sinh(u.v), v);
}
template <typename T>
Jet<T> tanh(const Jet<T>& u) {
  using std::tanh;
  const T v = tanh(u.v), first = T(1) - power(v, 2);
  return jet_rules::chain(u, v, first, T(-2) * v * first);
}

/// a^b for an exponent that varies: a > 0.
template <typename T>
Jet<T> power(const Jet<T>& a, const Jet<T>& b) {
  const Jet<T> exponent = b * log(a);
  const T v = power(a.v, b.v);
  return jet_rules::chain(exponent, v, v, v);
}

inline Jet<Quad> power(const Jet<Quad>& u, const Quad& n) {
  return jet_rules::chain(u, power(u.v, n), n * power(u.v, n - 1), n * (n - 1) * power(u.v, n - 2));
}

template <typename T>
Jet<T> abs(const Jet<T>& u) {
  return u.v < 0 ? -u : u;
}
Jet<Interval> abs(const Jet<Interval>& u);
template <typename T>
Jet<T> max(const Jet<T>& a, const Jet<T>& b) {
  using std::isnan;
  if (isnan(a.v) || isnan(b.v)) return a + b;
  return a.v > b.v ? a : b;
}
Jet<Interval> max(const Jet<Interval>& a, const Jet<Interval>& b);
template <typename T>
Jet<T> min(const Jet<T>& a, const Jet<T>& b) {
  return -max(-a, -b);
}

} // namespace domewarp
