// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpfr.h>

namespace domewarp {

/// A number of 60 decimal digits with the operations the reference curves need, so that references share no code with
/// what they judge.
class Real {
public:
  static constexpr mpfr_prec_t bits = 200;

  Real(double value = 0) {
    mpfr_init2(number_, bits);
    mpfr_set_d(number_, value, MPFR_RNDN);
  }
  Real(int value) : Real(static_cast<double>(value)) {}
  explicit Real(long double value) {
    mpfr_init2(number_, bits);
    mpfr_set_ld(number_, value, MPFR_RNDN);
  }
  explicit Real(const char* decimal) {
    mpfr_init2(number_, bits);
    mpfr_set_str(number_, decimal, 10, MPFR_RNDN);
  }
  Real(const Real& other) {
    mpfr_init2(number_, bits);
    mpfr_set(number_, other.number_, MPFR_RNDN);
  }
  Real& operator=(const Real& other) {
    mpfr_set(number_, other.number_, MPFR_RNDN);
    return *this;
  }
  ~Real() { mpfr_clear(number_); }

  explicit operator double() const { return mpfr_get_d(number_, MPFR_RNDN); }
  long double to_long_double() const { return mpfr_get_ld(number_, MPFR_RNDN); }
  bool is_nan() const { return mpfr_nan_p(number_) != 0; }
  int compare(double other) const { return mpfr_cmp_d(number_, other); }

  using Unary = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);
  using Binary = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);
  static Real apply(Unary function, const Real& a) {
    Real result;
    function(result.number_, a.number_, MPFR_RNDN);
    return result;
  }
  static Real apply(Binary function, const Real& a, const Real& b) {
    Real result;
    function(result.number_, a.number_, b.number_, MPFR_RNDN);
    return result;
  }

  friend bool operator<(const Real& a, const Real& b) { return mpfr_cmp(a.number_, b.number_) < 0; }

private:
  mpfr_t number_;
};

inline Real operator+(const Real& a, const Real& b) { return Real::apply(mpfr_add, a, b); }
inline Real operator-(const Real& a, const Real& b) { return Real::apply(mpfr_sub, a, b); }
inline Real operator*(const Real& a, const Real& b) { return Real::apply(mpfr_mul, a, b); }
inline Real operator/(const Real& a, const Real& b) { return Real::apply(mpfr_div, a, b); }
inline Real operator-(const Real& a) { return Real(0) - a; }
inline Real pow(const Real& a, const Real& b) { return Real::apply(mpfr_pow, a, b); }
inline Real sqrt(const Real& a) { return Real::apply(mpfr_sqrt, a); }
inline Real abs(const Real& a) { return Real::apply(mpfr_abs, a); }
inline Real exp(const Real& a) { return Real::apply(mpfr_exp, a); }
inline Real log(const Real& a) { return Real::apply(mpfr_log, a); }
inline Real log10(const Real& a) { return Real::apply(mpfr_log10, a); }
inline Real sin(const Real& a) { return Real::apply(mpfr_sin, a); }
inline Real cos(const Real& a) { return Real::apply(mpfr_cos, a); }
inline Real tan(const Real& a) { return Real::apply(mpfr_tan, a); }
inline Real cot(const Real& a) { return Real::apply(mpfr_cot, a); }
inline Real asin(const Real& a) { return Real::apply(mpfr_asin, a); }
inline Real acos(const Real& a) { return Real::apply(mpfr_acos, a); }
inline Real atan(const Real& a) { return Real::apply(mpfr_atan, a); }
inline Real atan2(const Real& y, const Real& x) { return Real::apply(mpfr_atan2, y, x); }
inline Real sinh(const Real& a) { return Real::apply(mpfr_sinh, a); }
inline Real cosh(const Real& a) { return Real::apply(mpfr_cosh, a); }
inline Real tanh(const Real& a) { return Real::apply(mpfr_tanh, a); }
inline Real pi() { return acos(Real(-1)); }

} // namespace domewarp
