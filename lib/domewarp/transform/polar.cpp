// SPDX-License-Identifier: Apache-2.0
#include "domewarp/transform/polar.h"

#include <algorithm>
#include <cmath>

namespace domewarp {

Polar polar(const Vec3& p) {
  double x = p.x, y = p.y, z = -p.z, unit = 1;
  const double size = std::max({std::abs(x), std::abs(y), std::abs(z)});
  if (!(size > 1e-100 && size < 1e100)) {
    if (!(size > 0 && std::isfinite(size))) return {};
    const int exponent = std::ilogb(size);
    unit = std::scalbn(1.0, exponent);
    x = std::scalbn(x, -exponent);
    y = std::scalbn(y, -exponent);
    z = std::scalbn(z, -exponent);
  }
  const double r2 = x * x + y * y;
  const double r = r2 > 1e-280 ? std::sqrt(r2) : std::hypot(x, y);
  return {x, y, r, z, std::sqrt(r2 + z * z), unit};
}

Vec2 side(const Polar& p) {
  if (p.r == 0) return {1, 0};
  if (p.r > 1e-290) return {p.x / p.r, p.y / p.r};
  constexpr double larger = 0x1p900; // denormal numbers have few digits, and so would their hypotenuse
  const double r = std::hypot(p.x * larger, p.y * larger);
  return {p.x * larger / r, p.y * larger / r};
}

} // namespace domewarp
