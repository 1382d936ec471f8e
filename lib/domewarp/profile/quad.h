// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace domewarp {

#ifdef __SIZEOF_FLOAT128__
using Float128 = __float128;
#else
using Float128 = long double; // 113 bits where the compiler has no type beside it
#endif

/// A number of 113 bits (34 digits), for questions that doubles cannot settle: beside a fold or on the edge of the
/// visible cone, where an ulp of the direction decides. Some fifty times slower than double.
/// The functions bear the names of their real counterparts, so that templates serve all kinds of numbers alike.
struct Quad {
  Float128 value = 0;

  Quad() = default;
  Quad(Float128 number) : value(number) {} ///< doubles and whole numbers convert to it exactly
  explicit operator double() const { return static_cast<double>(value); }
};

inline Quad operator-(const Quad& a) { return Quad(-a.value); }
inline Quad operator+(const Quad& a, const Quad& b) { return Quad(a.value + b.value); }
inline Quad operator-(const Quad& a, const Quad& b) { return Quad(a.value - b.value); }
inline Quad operator*(const Quad& a, const Quad& b) { return Quad(a.value * b.value); }
inline Quad operator/(const Quad& a, const Quad& b) { return Quad(a.value / b.value); }
inline bool operator<(const Quad& a, const Quad& b) { return a.value < b.value; }
inline bool operator>(const Quad& a, const Quad& b) { return a.value > b.value; }
inline bool operator<=(const Quad& a, const Quad& b) { return a.value <= b.value; }
inline bool operator>=(const Quad& a, const Quad& b) { return a.value >= b.value; }
inline bool operator==(const Quad& a, const Quad& b) { return a.value == b.value; }
inline bool isnan(const Quad& a) { return a.value != a.value; }
inline Quad abs(const Quad& a) { return a.value < 0 ? -a : a; }
bool isfinite(const Quad& a);

Quad power(const Quad& a, int exponent);
Quad power(const Quad& a, const Quad& b); ///< NaN for a < 0
Quad sqrt(const Quad& a);
Quad exp(const Quad& a);
Quad log(const Quad& a);
Quad log10(const Quad& a);
Quad sin(const Quad& a);
Quad cos(const Quad& a);
Quad tan(const Quad& a);
Quad cot(const Quad& a);
Quad asin(const Quad& a);
Quad acos(const Quad& a);
Quad atan(const Quad& a);
Quad atan2(const Quad& y, const Quad& x);
Quad sinh(const Quad& a);
Quad cosh(const Quad& a);
Quad tanh(const Quad& a);

Quad quad_pi();
Quad quad_e();

/// The number that a decimal text stands for, the same in every locale. @param text as std::from_chars() accepts it.
Quad parse_quad(std::string_view text);

} // namespace domewarp
