// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/exact.h"

#include <cmath>
#include <limits>

#include "domewarp/profile/root.h"

namespace domewarp {

namespace {

Quad fold_function(const Curve& curve, const Quad& r, double offset) {
  const Jet<Quad> f = differentiate(curve, r);
  return f.v - jet_rules::times(r, f.d) + offset;
}

// The last point of [lo, hi] at which `beyond` is false; it is true at hi.
template <typename Predicate>
Quad bisect(const Predicate& beyond, Quad lo, Quad hi) {
  for (;;) {
    const Quad middle = lo + 0.5 * (hi - lo);
    if (middle <= lo || middle >= hi) return lo;
    (beyond(middle) ? hi : lo) = middle;
  }
}

// As above for the one change of `beyond` that doubles place within `room` of r; r when it does not change there.
template <typename Predicate>
Quad find_change(const Predicate& beyond, double r, double room) {
  for (double width = r * std::numeric_limits<double>::epsilon(); width < room; width *= 4) {
    const Quad lo = r - width, hi = r + width;
    if (!beyond(lo) && beyond(hi)) return bisect(beyond, lo, hi);
  }
  return r;
}

struct LensRadius {
  Quad value, slope; // in theta, up to scale
};

LensRadius lens_radius(Lens lens, const Quad& theta) {
  const Quad half = 0.5 * theta;
  switch (lens) {
  case Lens::equidistant: return {theta, 1};
  case Lens::equisolid: return {sin(half), 0.5 * cos(half)};
  case Lens::stereographic: return {tan(half), 0.5 / power(cos(half), 2)};
  default: return {sin(theta), cos(theta)};
  }
}

} // namespace

QuadPoint about_axis(const Vec3& p) {
  const Quad x = p.x, y = p.y;
  return {sqrt(x * x + y * y), -p.z};
}

int side_of(const QuadPoint& end, const QuadPoint& direction) {
  const Quad sine = end.z * direction.r - end.r * direction.z;
  return sine > 0 ? 1 : sine < 0 ? -1 : 0;
}

QuadPoint point_on(const Curve& curve, const Quad& r) { return {r, differentiate(curve, r).v}; }

QuadPoint refine_fold(const Curve& curve, double r, double offset) {
  const double width = 1e-7 * r;
  const bool falls = fold_function(curve, r + width, offset) < 0;
  const auto beyond = [&](const Quad& at) { return (fold_function(curve, at, offset) < 0) == falls; };
  return point_on(curve, find_change(beyond, r, width));
}

QuadPoint refine_domain_end(const Curve& curve, double r) {
  if (curve.measured) return point_on(curve, r);
  const double room = 1e-14 * r;
  const Quad inside = differentiate(curve, Quad(r - room)).v;
  const auto beyond = [&](const Quad& at) {
    const Quad value = differentiate(curve, at).v;
    return !isfinite(value) || abs(value - inside) > 0.1 * (1 + abs(inside));
  };
  const Quad end = find_change(beyond, r, room);
  const Jet<Quad> f = differentiate(curve, end);
  // Where the tangent is vertical a height this small is what the last bit of r leaves of zero.
  const bool touches = abs(f.v) <= 1e-15 * end && abs(f.d) > 1e7;
  return {end, touches ? Quad(0) : f.v};
}

QuadPoint refine_picture_end(const Curve& curve, double r, double distance, double picture) {
  const auto beyond = [&](const Quad& at) {
    return !(at * distance <= picture * (differentiate(curve, at).v + distance));
  };
  return point_on(curve, find_change(beyond, r, 1e-7 * r));
}

QuadPoint meet(const Curve& curve, const QuadPoint& low, const QuadPoint& high, int orientation,
               const QuadPoint& direction, double guess) {
  if (side_of(low, direction) * orientation <= 0) return low;
  if (side_of(high, direction) * orientation >= 0) return high;
  const auto function = [&](const Quad& r) {
    const Jet<Quad> f = differentiate(curve, r);
    return ValueAndSlope<Quad>{f.v * direction.r - r * direction.z, f.d * direction.r - direction.z};
  };
  const Quad r = find_root(function, low.r, high.r, Quad(guess), orientation);
  return {r, direction.r > 0 ? r * (direction.z / direction.r) : low.z};
}

LensEnd refine_lens_end(Lens lens, double fov_deg, double theta, double distance, double picture) {
  const Quad edge = quad_pi() * (Quad(fov_deg) / 360), scale = 1 / lens_radius(lens, edge).value;
  const auto beyond = [&](const Quad& at) {
    const Quad r = scale * lens_radius(lens, at).value;
    if (std::isinf(distance)) return r > picture;
    return r * distance > picture * (r * cot(at) + distance);
  };
  const Quad end = std::isinf(picture) ? edge : find_change(beyond, theta, 1e-7 * theta);
  const auto [r, slope] = lens_radius(lens, end);
  const Quad s = sin(end), c = end == 0.5 * quad_pi() ? Quad(0) : cos(end);
  return {{scale * r, scale * r * c / s}, {slope, slope * c / s - r / (s * s)}};
}

} // namespace domewarp
