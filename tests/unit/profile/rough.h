// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>

#include "real.h"

namespace domewarp {

/// Thrown where an error bound leaves open which of two numbers is the smaller: sixty digits must tell.
struct Undecided {};

/// A long double with a bound of its error: answers most of what is asked of a Real, twenty times sooner, and knows when
/// it does not. Elementary functions are taken to be within four units in the last place (glibc documents one or two).
class Rough {
public:
  Rough(double value = 0) : value_(value) {}
  Rough(int value) : value_(value) {}
  explicit Rough(const char* decimal) : value_(std::strtold(decimal, nullptr)), error_(rounding(value_)) {}
  explicit Rough(const Real& x) : value_(x.to_long_double()), error_(rounding(value_)) {}

  long double value() const { return value_; }
  long double error() const { return error_; }
  bool contains(const Real& x) const { return !(Real(error_) < abs(x - Real(value_))); }

  friend Rough operator+(const Rough& a, const Rough& b) { return {a.value_ + b.value_, a.error_ + b.error_}; }
  friend Rough operator-(const Rough& a, const Rough& b) { return {a.value_ - b.value_, a.error_ + b.error_}; }
  friend Rough operator-(const Rough& a) { return Rough(-a.value_, a.error_, exact); }
  friend Rough operator*(const Rough& a, const Rough& b) {
    return {a.value_ * b.value_, std::abs(a.value_) * b.error_ + a.error_ * (std::abs(b.value_) + b.error_)};
  }
  friend Rough operator/(const Rough& a, const Rough& b) {
    const long double least = std::abs(b.value_) - b.error_, value = a.value_ / b.value_;
    return {value, least > 0 ? (a.error_ + std::abs(value) * b.error_) / least : unknown};
  }
  /// @throws Undecided
  friend bool operator<(const Rough& a, const Rough& b) {
    const long double difference = a.value_ - b.value_, error = (a.error_ + b.error_ + rounding(difference)) * slack;
    const bool is_exact = a.error_ == 0 && b.error_ == 0;
    if (is_exact) return a.value_ < b.value_;
    if (!(std::abs(difference) > error)) throw Undecided();
    return difference < 0;
  }

  friend Rough abs(const Rough& a) { return Rough(std::abs(a.value_), a.error_, exact); }
  friend Rough sqrt(const Rough& a) {
    const long double least = a.value_ - a.error_;
    if (a.error_ == 0) return {std::sqrt(a.value_), 0};
    return {std::sqrt(a.value_), least > 0 ? a.error_ / (2 * std::sqrt(least)) : unknown};
  }
  friend Rough exp(const Rough& a) {
    const long double value = std::exp(a.value_);
    return function(value, a.error_ < 0.1L ? 1.1L * value * a.error_ : unknown);
  }
  friend Rough log(const Rough& a) {
    const long double least = a.value_ - a.error_;
    return function(std::log(a.value_), least > 0 ? a.error_ / least : unknown);
  }
  friend Rough pow(const Rough& a, const Rough& b) { return exp(b * log(a)); }
  friend Rough sin(const Rough& a) { return function(std::sin(a.value_), a.error_); }
  friend Rough cos(const Rough& a) { return function(std::cos(a.value_), a.error_); }
  friend Rough tan(const Rough& a) { return sin(a) / cos(a); }
  friend Rough cot(const Rough& a) { return cos(a) / sin(a); }
  friend Rough tanh(const Rough& a) { return function(std::tanh(a.value_), a.error_); }
  friend Rough atan2(const Rough& y, const Rough& x) {
    const long double length = std::hypot(x.value_, y.value_) - x.error_ - y.error_;
    return function(std::atan2(y.value_, x.value_), length > 0 ? (x.error_ + y.error_) / length : unknown);
  }

private:
  struct Exact {};
  static constexpr Exact exact{};
  static constexpr long double unit = 0x1p-63L;   // of a rounding, twice its bound
  static constexpr long double slack = 1 + 0x1p-40L; // for the roundings of the bounds themselves
  static constexpr long double unknown = std::numeric_limits<long double>::infinity();

  static long double rounding(long double value) { return std::abs(value) * unit + std::numeric_limits<long double>::min(); }

  Rough(long double value, long double error) : value_(value), error_((error + rounding(value)) * slack) {}
  Rough(long double value, long double error, Exact) : value_(value), error_(error) {}
  static Rough function(long double value, long double error) { return {value, error + 8 * rounding(value)}; }

  long double value_ = 0, error_ = 0;
};

} // namespace domewarp
