// SPDX-License-Identifier: Apache-2.0
#include "domewarp/transform/continuation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace domewarp {

namespace {

constexpr double steepest = 1e4; ///< image units per radian: nothing but a fold
constexpr double least_share = 1.0 / 8; ///< of q at the end: K is as many times that of the end as its inverse

/// Whether the outer rim is this end of the branch.
bool is_rim(const Surface& surface, std::size_t branch, bool is_high) {
  return branch + 1 == surface.branches().size() && is_high == (surface.branches()[branch].orientation > 0);
}

} // namespace

Continuation::Continuation(const Surface& surface, std::size_t branch, bool is_high) {
  const Branch& range = surface.branches()[branch];
  theta_ = is_high ? range.theta_high : range.theta_low;
  radius_ = is_high ? range.radius_high : range.radius_low;
  sine_ = std::sin(theta_);
  cosine_ = theta_ == std::numbers::pi / 2 ? 0 : std::cos(theta_);
  const double slope = surface.radial(branch, theta_).dr;
  slope_ = std::abs(slope) < steepest ? slope : 0;
  const auto [point, tangent] = surface.rim();
  if (!is_rim(surface, branch, is_high) || tangent == Vec2(0, 0)) return;
  const double moment = point.y * tangent.x - point.x * tangent.y;
  a_ = tangent.x + (surface.options().projector ? moment / *surface.options().projector : 0);
  b_ = tangent.y;
  q_ = cosine_ * a_ - sine_ * b_;
  if (moment * q_ > 0) moment_ = moment;
}

double Continuation::radius(double sine, double cosine) const {
  if (!is_tangent()) return std::max(radius_ + slope_ * (sine * cosine_ - cosine * sine_), 0.0);
  const double share = std::max((cosine * a_ - sine * b_) / q_, 0.5 * least_share);
  return sine * moment_ / (q_ * share);
}

double Continuation::slope(double theta) const {
  if (!is_tangent()) return std::abs(slope_);
  const double q = std::cos(theta) * a_ - std::sin(theta) * b_;
  return std::abs(moment_ * a_) / (q * q);
}

RadialEnclosure Continuation::enclose(double theta_low, double theta_high) const {
  const Interval angle(theta_low, theta_high);
  if (!is_tangent()) {
    const Interval beyond = angle - Interval(theta_), s = sin(beyond), c = cos(beyond);
    const Interval r = Interval(radius_) + Interval(slope_) * s, unbounded = entire(Regularity::unknown);
    if (r.lo < -1e-9) return {unbounded, unbounded, unbounded}; // radius() stays at 0
    return {r, Interval(slope_) * c, Interval(-slope_) * s};
  }
  const Interval s = sin(angle), c = cos(angle), q = c * Interval(a_) - s * Interval(b_), share = q / Interval(q_);
  const Interval unbounded = entire(Regularity::unknown);
  if (!(share.lo > 0.9 * least_share)) return {unbounded, unbounded, unbounded};
  const Interval m(moment_), turn = s * Interval(a_) + c * Interval(b_);
  return {s * m / q, m * Interval(a_) / power(q, 2), Interval(2) * m * Interval(a_) * turn / power(q, 3)};
}

double Continuation::before_blind(double theta) const {
  const auto is_fine = [&](double angle) {
    return angle >= 0 && angle <= std::numbers::pi && (std::cos(angle) * a_ - std::sin(angle) * b_) / q_ >= least_share;
  };
  if (is_fine(theta)) return theta;
  double fine = theta_, bad = theta;
  for (int step = 0; step < 60; ++step) (is_fine(0.5 * (fine + bad)) ? fine : bad) = 0.5 * (fine + bad);
  return fine;
}

Branch drawn_branch(const Surface& surface, std::size_t branch) {
  Branch drawn = surface.branches()[branch];
  const double extension = surface.options().extension_deg * std::numbers::pi / 180;
  const bool is_high = drawn.orientation > 0;
  if (extension == 0 || !is_rim(surface, branch, is_high)) return drawn;
  const Continuation beyond(surface, branch, is_high);
  double& theta = is_high ? drawn.theta_high : drawn.theta_low;
  constexpr double flattest = 1e-6; // a vertical tangent leads nowhere in the image
  if (!beyond.is_tangent() || !(beyond.slope(theta) > flattest)) return drawn;
  theta = beyond.before_blind(is_high ? theta + extension : theta - extension);
  (is_high ? drawn.radius_high : drawn.radius_low) = beyond.radius(std::sin(theta), std::cos(theta));
  return drawn;
}

} // namespace domewarp
