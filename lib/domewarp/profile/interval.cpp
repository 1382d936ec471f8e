// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/interval.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace domewarp {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int function_ulps = 8;

double below(double x) { return std::nextafter(x, -infinity); }
double above(double x) { return std::nextafter(x, infinity); }

Regularity weaker(Regularity a, Regularity b) { return std::min(a, b); }
Regularity weaker(const Interval& a, const Interval& b) { return weaker(a.regularity, b.regularity); }

double lowered(double x) {
  for (int i = 0; i < function_ulps; ++i) x = below(x);
  return x;
}
double raised(double x) {
  for (int i = 0; i < function_ulps; ++i) x = above(x);
  return x;
}

Interval outward(double lo, double hi, Regularity known) { return {below(lo), above(hi), known}; }

// NaN bounds come from infinities that cancel: nothing is known then.
Interval checked(double lo, double hi, Regularity known) {
  return {std::isnan(lo) ? -infinity : lo, std::isnan(hi) ? infinity : hi, known};
}

// The image of a monotone function, kept inside the function's own range.
template <typename Function>
Interval rising(const Interval& a, Function f, double least = -infinity, double most = infinity) {
  return checked(std::max(lowered(f(a.lo)), least), std::min(raised(f(a.hi)), most), a.regularity);
}

double product(double a, double b) { return a == 0 || b == 0 ? 0 : a * b; }

// Whether some point offset + k period lies in a, with a margin for the rounding of the argument's reduction.
bool meets(const Interval& a, double offset, double period) {
  const double margin = 1e-15 * (1 + std::max(std::abs(a.lo), std::abs(a.hi)));
  const double first = std::ceil((a.lo - margin - offset) / period - 1e-12);
  return first * period + offset <= a.hi + margin + 1e-12;
}

// Beyond this the reduction modulo pi above is not certain; the functions then take their whole range.
constexpr double periodic_limit = 1e6;

bool is_reducible(const Interval& a) { return std::max(std::abs(a.lo), std::abs(a.hi)) < periodic_limit; }

Interval sine_like(const Interval& a, double (*f)(double), double top) {
  constexpr double pi = std::numbers::pi;
  if (!is_reducible(a) || a.hi - a.lo >= 2 * pi) return {-1, 1, a.regularity};
  const double at_lo = f(a.lo), at_hi = f(a.hi);
  const double lo = meets(a, top + pi, 2 * pi) ? -1 : std::max(lowered(std::min(at_lo, at_hi)), -1.0);
  const double hi = meets(a, top, 2 * pi) ? 1 : std::min(raised(std::max(at_lo, at_hi)), 1.0);
  return {lo, hi, a.regularity};
}

} // namespace

bool is_bounded(const Interval& a) { return std::isfinite(a.lo) && std::isfinite(a.hi); }

Interval around(double value) {
  const bool exact = value == std::nearbyint(value) && std::abs(value) < 1e15;
  return exact ? Interval(value) : Interval(below(value), above(value));
}

Interval entire(Regularity known) { return {-infinity, infinity, known}; }

Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi), weaker(a, b)};
}

Interval intersect(const Interval& a, const Interval& b) {
  const double lo = std::max(a.lo, b.lo), hi = std::min(a.hi, b.hi);
  return lo <= hi ? Interval(lo, hi, a.regularity) : a;
}

Interval operator-(const Interval& a) { return {-a.hi, -a.lo, a.regularity}; }

Interval operator+(const Interval& a, const Interval& b) {
  return checked(below(a.lo + b.lo), above(a.hi + b.hi), weaker(a, b));
}

Interval operator-(const Interval& a, const Interval& b) { return a + -b; }

Interval operator*(const Interval& a, const Interval& b) {
  const auto [lo, hi] =
      std::minmax({product(a.lo, b.lo), product(a.lo, b.hi), product(a.hi, b.lo), product(a.hi, b.hi)});
  return checked(below(lo), above(hi), weaker(a, b));
}

Interval operator/(const Interval& a, const Interval& b) {
  if (b.lo < 0 && b.hi > 0) return entire(Regularity::unknown);
  if (b.lo == 0 && b.hi == 0) return entire(Regularity::unknown);
  const Regularity known = contains(b, 0) ? Regularity::unknown : weaker(a, b);
  const Interval inverse(b.hi == 0 ? -infinity : below(1 / b.hi), b.lo == 0 ? infinity : above(1 / b.lo));
  Interval result = a * inverse;
  if (known != Regularity::unknown) {
    // Dividing the bounds rounds once; multiplying by the inverse is only needed for infinite ones.
    const auto [lo, hi] = std::minmax({a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi});
    if (!std::isnan(lo + hi)) result = outward(lo, hi, known);
  }
  result.regularity = known;
  return result;
}

Interval power(const Interval& a, int exponent) {
  if (exponent == 0) return {1, 1, a.regularity};
  if (exponent < 0) return Interval(1) / power(a, -exponent);
  const auto raise = [exponent](double x) { return std::pow(x, exponent); };
  if (exponent % 2 != 0) return rising(a, raise, a.lo >= 0 ? 0 : -infinity);
  const Interval size = abs(a);
  Interval result = rising(size, raise, 0);
  result.regularity = a.regularity;
  return result;
}

Interval power(const Interval& a, double exponent) {
  if (exponent < 0) return Interval(1) / power(a, -exponent);
  const Regularity known = a.lo > 0    ? a.regularity
                           : a.lo == 0 ? weaker(a.regularity, Regularity::continuous)
                                       : Regularity::unknown;
  if (a.hi < 0) return entire(Regularity::unknown);
  const double lo = std::max(a.lo, 0.0);
  const double less = below(exponent), more = above(exponent);
  return {std::max(0.0, lowered(std::min(std::pow(lo, less), std::pow(lo, more)))),
          raised(std::max(std::pow(a.hi, less), std::pow(a.hi, more))), known};
}

Interval power(const Interval& a, const Interval& b) { return exp(b * log(a)); }

Interval sqrt(const Interval& a) {
  if (a.hi < 0) return entire(Regularity::unknown);
  const Regularity known = a.lo > 0    ? a.regularity
                           : a.lo == 0 ? weaker(a.regularity, Regularity::continuous)
                                       : Regularity::unknown;
  return {a.lo <= 0 ? 0 : below(std::sqrt(a.lo)), above(std::sqrt(a.hi)), known};
}

Interval exp(const Interval& a) {
  return rising(
      a, [](double x) { return std::exp(x); }, 0);
}

Interval log(const Interval& a) {
  if (a.hi <= 0) return entire(Regularity::unknown);
  const Regularity known = a.lo > 0 ? a.regularity : Regularity::unknown;
  return {a.lo > 0 ? lowered(std::log(a.lo)) : -infinity, raised(std::log(a.hi)), known};
}

Interval log10(const Interval& a) {
  if (a.hi <= 0) return entire(Regularity::unknown);
  const Regularity known = a.lo > 0 ? a.regularity : Regularity::unknown;
  return {a.lo > 0 ? lowered(std::log10(a.lo)) : -infinity, raised(std::log10(a.hi)), known};
}

Interval sin(const Interval& a) { return sine_like(a, std::sin, std::numbers::pi / 2); }
Interval cos(const Interval& a) { return sine_like(a, std::cos, 0); }

Interval tan(const Interval& a) {
  if (!is_reducible(a) || meets(a, std::numbers::pi / 2, std::numbers::pi)) return entire(Regularity::unknown);
  return rising(a, [](double x) { return std::tan(x); });
}

Interval cot(const Interval& a) {
  if (!is_reducible(a) || meets(a, 0, std::numbers::pi)) return entire(Regularity::unknown);
  return {lowered(1 / std::tan(a.hi)), raised(1 / std::tan(a.lo)), a.regularity};
}

Interval asin(const Interval& a) {
  if (a.hi < -1 || a.lo > 1) return entire(Regularity::unknown);
  const bool inside = a.lo >= -1 && a.hi <= 1;
  Regularity known = inside ? a.regularity : Regularity::unknown;
  if (inside && (a.lo == -1 || a.hi == 1)) known = weaker(known, Regularity::continuous);
  return {lowered(std::asin(std::max(a.lo, -1.0))), raised(std::asin(std::min(a.hi, 1.0))), known};
}

Interval acos(const Interval& a) {
  const Interval complement = asin(a);
  if (!is_bounded(complement)) return complement;
  return {lowered(std::acos(std::min(a.hi, 1.0))), raised(std::acos(std::max(a.lo, -1.0))), complement.regularity};
}

Interval atan(const Interval& a) {
  return rising(a, [](double x) { return std::atan(x); });
}

Interval sinh(const Interval& a) {
  return rising(a, [](double x) { return std::sinh(x); });
}

Interval cosh(const Interval& a) {
  Interval result = rising(
      abs(a), [](double x) { return std::cosh(x); }, 1);
  result.regularity = a.regularity;
  return result;
}

Interval tanh(const Interval& a) {
  return rising(
      a, [](double x) { return std::tanh(x); }, -1, 1);
}

Interval abs(const Interval& a) {
  if (a.lo >= 0) return a;
  if (a.hi <= 0) return -a;
  return {0, std::max(-a.lo, a.hi), weaker(a.regularity, Regularity::continuous)};
}

Interval min(const Interval& a, const Interval& b) { return -max(-a, -b); }

Interval max(const Interval& a, const Interval& b) {
  const Regularity both = weaker(a, b);
  const bool decided = a.lo >= b.hi || b.lo >= a.hi;
  return {std::max(a.lo, b.lo), std::max(a.hi, b.hi), decided ? both : weaker(both, Regularity::continuous)};
}

} // namespace domewarp
