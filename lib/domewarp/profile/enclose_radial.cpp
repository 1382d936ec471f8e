// SPDX-License-Identifier: Apache-2.0
//
// d/dtheta = (q / h) d/dr along a curve, q = r^2 + f^2, h = f - r f', so R' and R'' follow from enclosures of f, f', f''
// over the radii that the angles span. Lenses are differentiated in theta itself.
#include <algorithm>
#include <cmath>

#include "domewarp/profile/surface_parts.h"

namespace domewarp {

namespace {

using IntervalJet = Jet<Interval>;

IntervalJet constant(double value) { return {Interval(value), Interval(0), Interval(0)}; }

// Theta cot(theta) has a Taylor series whose terms are all negative but the first: it and its derivatives fall.
IntervalJet equidistant_depth(const LensForm& lens, const Interval& theta) {
  const RadialJet first = depth(lens, theta.lo), last = depth(lens, theta.hi);
  const auto falling = [](double at_low, double at_high) {
    const double margin = 1e-12 * (1 + std::max(std::abs(at_low), std::abs(at_high)));
    return Interval(at_high - margin, at_low + margin);
  };
  return {falling(first.r, last.r), falling(first.dr, last.dr), falling(first.d2r, last.d2r)};
}

IntervalJet lens_radius(const LensForm& lens, const IntervalJet& theta) {
  const IntervalJet a = constant(lens.scale), half = constant(0.5) * theta;
  switch (lens.lens) {
  case Lens::equidistant: return a * theta;
  case Lens::equisolid: return a * sin(half);
  case Lens::stereographic: return a * tan(half);
  default: return a * sin(theta);
  }
}

/// z = R cot(theta).
IntervalJet lens_depth(const LensForm& lens, const IntervalJet& theta) {
  const IntervalJet a = constant(lens.scale), half = constant(0.5) * theta;
  switch (lens.lens) {
  case Lens::equidistant: return equidistant_depth(lens, theta.v);
  case Lens::equisolid: return constant(0.5) * a * cos(theta) / cos(half);
  case Lens::stereographic: return constant(0.5) * a * (constant(1) - power(tan(half), 2));
  default: return a * cos(theta);
  }
}

IntervalJet compensate(double distance, const IntervalJet& r, const IntervalJet& z) {
  return std::isinf(distance) ? r : constant(distance) * r / (z + constant(distance));
}

RadialEnclosure along_curve(const Curve& curve, double distance, const Interval& cell) {
  const IntervalJet f = enclose_jet(curve, cell);
  const IntervalJet image = compensate(distance, {cell, Interval(1), Interval(0)}, f);
  const Interval q = power(cell, 2) + power(f.v, 2), dq = Interval(2) * (cell + f.v * f.d);
  const Interval h = f.v - cell * f.d, dh = -(cell * f.dd);
  const Interval rate = q / h, d_rate = (dq - rate * dh) / h; // dr/dtheta and its derivative in r
  return {image.v, image.d * rate, power(rate, 2) * image.dd + rate * d_rate * image.d};
}

RadialEnclosure hull(const RadialEnclosure& a, const RadialEnclosure& b) {
  return {hull(a.r, b.r), hull(a.dr, b.dr), hull(a.d2r, b.d2r)};
}

/// The radii along the curve that the angles span, widened by the rounding of the root.
Interval radii(const SurfaceParts& parts, const Span& span, double theta_low, double theta_high) {
  const auto radius = [&](double theta) {
    if (theta == span.theta_at_low) return span.r_low;
    if (theta == span.theta_at_high) return span.r_high;
    return curve_point(parts.curve, span, std::sin(theta), std::cos(theta)).x;
  };
  const auto [low, high] = std::minmax({radius(theta_low), radius(theta_high)});
  constexpr double rounding = 4e-15;
  return {std::max(span.r_low, low - rounding * span.r_high), std::min(span.r_high, high + rounding * span.r_high)};
}

} // namespace

RadialEnclosure Surface::enclose(std::size_t branch, double theta_low, double theta_high) const {
  const SurfaceParts& parts = *parts_;
  const Branch& range = parts.branches[branch];
  theta_low = std::clamp(theta_low, range.theta_low, range.theta_high);
  theta_high = std::clamp(theta_high, range.theta_low, range.theta_high);
  if (parts.lens) {
    const IntervalJet theta{Interval(theta_low, theta_high), Interval(1), Interval(0)};
    const IntervalJet z = std::isinf(parts.distance) ? constant(0) : lens_depth(*parts.lens, theta);
    const IntervalJet image = compensate(parts.distance, lens_radius(*parts.lens, theta), z);
    return {image.v, image.d, image.dd};
  }
  const Interval cell = radii(parts, parts.spans[branch], theta_low, theta_high);
  const std::vector<double>& joints = parts.curve.joints;
  auto joint = std::upper_bound(joints.begin(), joints.end(), cell.lo);
  double from = cell.lo;
  std::optional<RadialEnclosure> whole;
  for (;; ++joint) {
    const bool is_last = joint == joints.end() || *joint >= cell.hi;
    const double to = is_last ? cell.hi : *joint;
    const RadialEnclosure piece = along_curve(parts.curve, parts.distance, {from, to});
    whole = whole ? hull(*whole, piece) : piece;
    if (is_last) return *whole;
    from = to;
  }
}

} // namespace domewarp
