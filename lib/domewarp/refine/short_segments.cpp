// SPDX-License-Identifier: Apache-2.0
// The part of the error bound that takes a whole small figure at once.
#include <algorithm>
#include <cmath>
#include <limits>

#include "domewarp/refine/error_bound.h"

namespace domewarp {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double widest = 0.1; ///< radians; the factors below hold up to there
constexpr double slack = 1e-9;

/// Of the angle theta with this half-angle index; infinite on the axes.
double cotangent(double u) { return (1 - 2 * u) / (2 * u * (1 - u)); }

} // namespace

double small_angle(double longest, double nearest) {
  const double angle = longest / (nearest - longest);
  return nearest > longest && angle <= widest ? angle : infinity;
}

// With kappa <= angle, |c| <= |W'| + W angle, |I_psi| <= max(|R'|, |K|) and |I_psipsi|^2 <= max(|A|, |B|)^2 + C^2 in the
// terms of ErrorBound. For the depth 1 / cos(psi / 2) - 1 <= 0.126 psi^2; the interpolated g is off by at most a quarter of
// the range of its slope x g' dpsi/dt, where |dx/dpsi| = |sin(chi)^2 cot(theta)| and dpsi/dt varies by 1 / cos(psi / 2)^2. Over a
// face x is that of a fixed direction: it changes by at most |cot(theta)| psi, and by psi^2 as the segments leave the sphere's
// tangent plane. Faces are then off by at most 4/3 of this bound: sum m_i m_j <= 1/3 where it is 1/4 on an edge.
EdgeBend ErrorBound::short_segments(const ShortSegments& s) const {
  const EdgeBend unknown{infinity, infinity};
  const double angle = s.angle, margin = u_margin(angle);
  if (!(angle < infinity)) return unknown;
  const double u_low = std::max(0.0, s.u_low - margin), u_high = std::min(1.0, s.u_high + margin);
  const BriefRange r = ranges_.brief(u_low, u_high);
  const double change = s.weight_high - s.weight_low + s.weight_high * angle;
  EdgeBend bound;
  bound.second = angle * (angle * s.weight_high * r.bend + 2 * change * r.speed) * (1 + slack);
  bound.depth = 0.126 * angle * angle;
  if (projection_ == Projection::perspective) {
    const double turn = std::min(2.0, 1.01 * angle * std::max(std::abs(cotangent(u_low)), std::abs(cotangent(u_high))));
    const double range = 1.01 * (r.weight_slope.high - r.weight_slope.low) + magnitude(r.weight_slope) * (1.01 * turn + 1.27 * angle * angle);
    bound.depth += (1 + bound.depth) * 0.25 * angle * range * r.inverse_weight;
  }
  return bound.second < infinity && bound.depth < infinity ? bound : unknown;
}

} // namespace domewarp
