// SPDX-License-Identifier: Apache-2.0
#include "domewarp/transform/weight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "domewarp/transform/image_map.h"

namespace domewarp {

namespace {

constexpr double e2 = BranchMap::weight_epsilon * BranchMap::weight_epsilon;

// b = (q^2 + e^2) / (1 + q^2 e^2) with its derivative by theta; in terms of 1 / q^2 where q is large.
Vec2 blend(double slope, double second, double mean) {
  const double q = slope / mean;
  if (std::abs(q) <= 1) {
    const double bottom = 1 + q * q * e2;
    return {(q * q + e2) / bottom, (1 - e2 * e2) * 2 * q * (second / mean) / (bottom * bottom)};
  }
  const double i = 1 / q / q, di = -2 * i / q * (second / mean);
  return {(1 + e2 * i) / (i + e2), -(1 - e2 * e2) * di / ((i + e2) * (i + e2))};
}

// g and g' from b^(-1/4).
Vec2 weight_and_slope(const Surface& surface, std::size_t branch, double theta, double mean) {
  const RadialJet jet = surface.radial(branch, theta);
  const Vec2 b = blend(jet.dr, jet.d2r, mean);
  const double g = 1 / std::sqrt(std::sqrt(b.x));
  const double slope = -0.25 * g * b.y / b.x;
  return {g, std::isfinite(slope) ? slope : 0}; // R' and R'' beyond the range of a double: g is at a bound
}

} // namespace

double weight(double slope, double mean) { return 1 / std::sqrt(std::sqrt(blend(slope, 0, mean).x)); }

double mean_slope(const Surface& surface, std::size_t index) {
  const Branch& branch = surface.branches()[index];
  // The joints of a measured profile are smooth enough: R' is continuous there.
  const bool has_kink = surface.options().profile.empty() && !surface.joints(index).empty();
  if (branch.fold_low || branch.fold_high || has_kink) return std::numeric_limits<double>::infinity();
  return std::abs(branch.radius_high - branch.radius_low) / (branch.theta_high - branch.theta_low);
}

Vec3 weight_jet(const Surface& surface, std::size_t branch, double theta) {
  const Branch& range = surface.branches()[branch];
  const std::vector<double>& joints = surface.joints(branch);
  const auto next = std::upper_bound(joints.begin(), joints.end(), theta);
  const double lo = next == joints.begin() ? range.theta_low : *(next - 1);
  const double hi = next == joints.end() ? range.theta_high : *next;
  const double mean = mean_slope(surface, branch);
  // Nothing of a picture is that narrow, and the differences below would be rounding.
  constexpr double narrow = 1e-9;
  if (hi - lo < narrow) return {weight_and_slope(surface, branch, theta, mean).x, 0, 0};
  // g'' is a difference of exact first derivatives, which keeps off the ends: R'' may be infinite there.
  const double width = std::min(1e-5, 0.2 * (hi - lo));
  const double centre = std::clamp(theta, lo + 1.5 * width, hi - 1.5 * width);
  const Vec2 before = weight_and_slope(surface, branch, centre - width, mean);
  const Vec2 after = weight_and_slope(surface, branch, centre + width, mean);
  const double at = std::clamp(theta, lo + 1e-3 * width, hi - 1e-3 * width);
  const Vec2 here = weight_and_slope(surface, branch, at, mean);
  return {here.x, here.y, (after.y - before.y) / (2 * width)};
}

} // namespace domewarp
