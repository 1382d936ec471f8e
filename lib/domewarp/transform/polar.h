// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/core/vectors.h"

namespace domewarp {

/// An eye-space point about the principal axis, divided by a power of two where its squares would overflow or vanish:
/// the map depends on the direction only.
struct Polar {
  double x = 0, y = 0;
  double r = 0, z = 1; ///< distance from the axis, forward distance
  double rho = 1;      ///< hypotenuse of r and z
  double unit = 1;     ///< the power of two
};

/// @param p finite; zero counts as a point straight ahead.
Polar polar(const Vec3& p);

/// (x, y) / r, exact to rounding down to the smallest numbers; (1, 0) on the axis.
Vec2 side(const Polar& p);

} // namespace domewarp
