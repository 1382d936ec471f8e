// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/jet.h"

namespace domewarp {

double power(double x, int exponent) {
  switch (exponent) {
  case 1: return x;
  case 2: return x * x;
  case 3: return x * x * x;
  default: return std::pow(x, exponent);
  }
}

Jet<Interval> abs(const Jet<Interval>& u) {
  if (u.v.lo >= 0) return u;
  if (u.v.hi <= 0) return -u;
  return {abs(u.v), hull(u.d, -u.d), entire(Regularity::continuous)};
}

Jet<Interval> max(const Jet<Interval>& a, const Jet<Interval>& b) {
  const Interval value = max(a.v, b.v);
  if (a.v.lo >= b.v.hi) return {value, a.d, a.dd};
  if (b.v.lo >= a.v.hi) return {value, b.d, b.dd};
  return {value, hull(a.d, b.d), entire(Regularity::continuous)};
}

} // namespace domewarp
