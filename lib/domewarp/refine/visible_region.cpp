// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/visible_region.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace domewarp {

double highest_angle(const Branch& branch) { return std::min(branch.theta_high, std::numbers::pi - blind_angle); }

VisibleRegion make_visible_region(const Branch& branch, double near) {
  VisibleRegion region;
  if (branch.theta_low > 0)
    region.boundaries.push_back({Boundary::Kind::low_cone, std::sin(branch.theta_low), std::cos(branch.theta_low), 0});
  const double high = highest_angle(branch);
  region.boundaries.push_back({Boundary::Kind::high_cone, std::sin(high), std::cos(high), 0});
  region.boundaries.push_back({Boundary::Kind::near_sphere, 0, 0, near});
  return region;
}

bool share_boundary(const Sides& p, const Sides& q) {
  for (std::size_t i = 0; i < p.size(); ++i)
    if (p[i] == 0 && q[i] == 0) return true;
  return false;
}

double signed_distance(const Boundary& boundary, const Vec3& p) {
  if (boundary.kind == Boundary::Kind::near_sphere) return glm::length(p) - boundary.radius;
  const double beyond = -p.z * boundary.sine - std::hypot(p.x, p.y) * boundary.cosine;
  return boundary.kind == Boundary::Kind::high_cone ? beyond : -beyond;
}

Sides sides_of(const VisibleRegion& region, const Vec3& p) {
  // Rounding of the signed distance is a few ulp of |p|; a point nearer than that may be on either side, so it is on.
  constexpr double on = 1e-14;
  Sides sides{1, 1, 1};
  for (std::size_t i = 0; i < region.boundaries.size(); ++i) {
    const double distance = signed_distance(region.boundaries[i], p);
    const double tolerance = on * (glm::length(p) + region.boundaries[i].radius);
    sides[i] = distance > tolerance ? 1 : distance < -tolerance ? -1 : 0;
  }
  return sides;
}

// Bisection safeguards a secant step (Illinois). Quadratic formulas for cone and sphere were as fast but lost half the
// digits for edges that graze the boundary.
double crossing(const Boundary& boundary, const Vec3& a, const Vec3& b) {
  double low = 0, high = 1;
  double at_low = signed_distance(boundary, a), at_high = signed_distance(boundary, b);
  double t = 0.5;
  int same_end = 0;
  for (int step = 0; step < 200 && high - low > 0x1p-53; ++step) {
    t = step % 8 == 7 ? 0.5 * (low + high) : low + (high - low) * (at_low / (at_low - at_high));
    if (!(t > low && t < high)) t = 0.5 * (low + high);
    const double value = signed_distance(boundary, point_at(a, b, t));
    if (value == 0) return t;
    const bool replaces_low = (value > 0) == (at_low > 0);
    (replaces_low ? low : high) = t;
    (replaces_low ? at_low : at_high) = value;
    if (same_end == (replaces_low ? 1 : 2)) (replaces_low ? at_high : at_low) *= 0.5;
    same_end = replaces_low ? 1 : 2;
  }
  return t;
}

std::optional<double> extremum(const Boundary& boundary, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  double numerator = -glm::dot(a, d), denominator = glm::dot(d, d);
  if (boundary.kind != Boundary::Kind::near_sphere) {
    numerator = a.z * glm::dot(a, d) - d.z * glm::dot(a, a);
    denominator = d.z * glm::dot(a, d) - a.z * glm::dot(d, d);
  }
  const double t = numerator / denominator;
  if (t > 0 && t < 1) return t;
  return std::nullopt;
}

} // namespace domewarp
