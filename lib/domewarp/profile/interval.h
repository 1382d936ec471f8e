// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace domewarp {

/// What is certain about a function over a whole cell of arguments.
enum class Regularity : char {
  unknown,    ///< may be undefined or jump somewhere in the cell
  continuous, ///< defined and continuous everywhere
  smooth,     ///< differentiable without end
};

/// A closed interval that contains every value a function takes where it is defined; bounds may be infinite. Every
/// operation rounds outwards: 1 ulp for arithmetic, 8 ulp for elementary functions (glibc documents at most 3).
/// The functions below bear the names of their real counterparts, so that templates serve doubles and intervals alike.
struct Interval {
  double lo = 0, hi = 0;
  Regularity regularity = Regularity::smooth;

  Interval() = default;
  Interval(double value) : lo(value), hi(value) {}
  Interval(double low, double high, Regularity known = Regularity::smooth) : lo(low), hi(high), regularity(known) {}
};

inline bool contains(const Interval& a, double x) { return a.lo <= x && x <= a.hi; }
bool is_bounded(const Interval& a);

/// The tightest interval that is certain to contain a decimal number of which `value` is the nearest double.
Interval around(double value);
Interval entire(Regularity known);
Interval hull(const Interval& a, const Interval& b);
/// The common part; when rounding left none, `a`.
Interval intersect(const Interval& a, const Interval& b);

Interval operator-(const Interval& a);
Interval operator+(const Interval& a, const Interval& b);
Interval operator-(const Interval& a, const Interval& b);
/// Zero times infinity is zero here: infinite bounds stand for arbitrarily large finite values.
Interval operator*(const Interval& a, const Interval& b);
/// Unknown regularity when b contains zero.
Interval operator/(const Interval& a, const Interval& b);

Interval power(const Interval& a, int exponent);
Interval power(const Interval& a, double exponent);   ///< a >= 0; the exponent may be off by an ulp
Interval power(const Interval& a, const Interval& b); ///< a > 0
Interval sqrt(const Interval& a);
Interval exp(const Interval& a);
Interval log(const Interval& a);
Interval log10(const Interval& a);
Interval sin(const Interval& a);
Interval cos(const Interval& a);
Interval tan(const Interval& a);
Interval cot(const Interval& a);
Interval asin(const Interval& a);
Interval acos(const Interval& a);
Interval atan(const Interval& a);
Interval sinh(const Interval& a);
Interval cosh(const Interval& a);
Interval tanh(const Interval& a);
Interval abs(const Interval& a);
Interval min(const Interval& a, const Interval& b);
Interval max(const Interval& a, const Interval& b);

} // namespace domewarp
