// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace domewarp {

/// The half-angle index n / (n + o), tan(theta / 2) = n / o: 0 to 1 from the forward axis to the backward one, analytic in
/// theta. s = sin(theta) >= 0, c = cos(theta) or any positive multiple of both, `length` their hypotenuse.
inline double half_angle_index(double s, double c, double length) {
  const double a = length + (c < 0 ? -c : c);
  return c < 0 ? a / (a + s) : s / (s + a);
}

} // namespace domewarp
