// SPDX-License-Identifier: Apache-2.0
// Based on: the edge-local tests of DiagSplit (Fisher et al. 2009), the certificate max |e| <= max_i |e(i/n)| + B/n^2
// for an error with bounded second derivative, extended here to perspective-correct interpolation.
#include "domewarp/refine/edge_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

namespace domewarp {

namespace {

/// Edges shorter than this angle are never split: 1e-7 of an image is far below a pixel's thousandth.
constexpr double smallest_angle = 1e-9;

/// A bound that an eighth of the edge still exceeds by this factor although samples do not is no bound at all.
constexpr double hopeless = 64;

Vec3 homogeneous(const Mapped& m) { return Vec3(m.image * m.weight, m.weight); }

Vec2 dehomogenise(const Vec3& q) { return Vec2(q) / q.z; }

Vec3 interpolate(const Mapped& a, const Mapped& b, double t) { return homogeneous(a) * (1 - t) + homogeneous(b) * t; }

/// Bound of the distance in the image between two segments drawn over the same parameter, exact at the ends: the
/// difference of two rational linear functions has a quadratic numerator, bounded by its Bernstein coefficients.
double segment_distance(const Vec3& l0, const Vec3& l1, const Vec3& q0, const Vec3& q1) {
  const Vec2 n0 = Vec2(l0) * q0.z - Vec2(q0) * l0.z;
  const Vec2 n2 = Vec2(l1) * q1.z - Vec2(q1) * l1.z;
  const Vec2 n1 = 0.5 * (Vec2(l0) * q1.z + Vec2(l1) * q0.z - Vec2(q0) * l1.z - Vec2(q1) * l0.z);
  const double largest = std::sqrt(std::max({glm::dot(n0, n0), glm::dot(n1, n1), glm::dot(n2, n2)}));
  return largest / (std::min(l0.z, l1.z) * std::min(q0.z, q1.z));
}

/// The angle that moves the rim by a tenth of the tolerance.
double unnoticed_angle(const Surface& surface, std::size_t branch, double tolerance) {
  const Branch& b = surface.branches()[branch];
  const double slope = std::max(std::abs(surface.radial(branch, b.theta_low).dr), std::abs(surface.radial(branch, b.theta_high).dr));
  return 0.1 * tolerance / std::clamp(slope, 1.0, 1e4);
}

} // namespace

EdgeOracle::EdgeOracle(const Surface& surface, std::size_t branch, const BranchMap& map, VisibleRegion region,
                       const OracleOptions& options)
    : map_(map), region_(std::move(region)), options_(options), bound_(surface, branch, map, options.projection),
      rim_angle_(unnoticed_angle(surface, branch, options.tolerance)) {}

Mapped EdgeOracle::map_point(const Vec3& eye) const {
  const RadialFactors factors = map_.factors(eye);
  const double rho = glm::length(eye);
  const double scale = factors.k / rho;
  return {Vec2(eye.x * scale, eye.y * scale), options_.projection == Projection::perspective ? rho * factors.g : 1.0};
}

MappedPoint EdgeOracle::locate(const Vec3& eye, int on) const {
  MappedPoint point{eye, sides_of(region_, eye), {}};
  if (on >= 0) point.sides[on] = 0;
  if (*std::min_element(point.sides.begin(), point.sides.end()) >= 0) point.mapped = map_point(eye);
  return point;
}

std::optional<Split> EdgeOracle::split_at_boundary(const MappedPoint& a, const MappedPoint& b, bool& outside) const {
  const auto split = [&](double t, int on) -> std::optional<Split> {
    const Vec3 eye = point_at(a.eye, b.eye, t);
    if (eye == a.eye || eye == b.eye) return std::nullopt;
    return Split{t, locate(eye, on)};
  };
  for (int i = 0; i < static_cast<int>(region_.boundaries.size()); ++i)
    if (a.sides[i] * b.sides[i] < 0)
      if (auto found = split(crossing(region_.boundaries[i], a.eye, b.eye), i)) return found;
  for (int i = 0; i < static_cast<int>(region_.boundaries.size()); ++i) {
    const Boundary& boundary = region_.boundaries[i];
    const int side = a.sides[i] + b.sides[i]; // 0 only when both are on the boundary: a chord, judged by its sagitta
    if (side != 0) {
      if (const std::optional<double> t = extremum(boundary, a.eye, b.eye)) {
        const Vec3 eye = point_at(a.eye, b.eye, *t);
        const double dip = -side * signed_distance(boundary, eye);
        const double unnoticed = boundary.kind == Boundary::Kind::near_sphere ? 1e-3 * boundary.radius
                                                                             : rim_angle_ * glm::length(eye);
        if (dip > unnoticed)
          if (auto found = split(*t, -1)) return found;
      }
    }
    if (side < 0) {
      outside = true;
      return std::nullopt;
    }
  }
  return std::nullopt;
}

// The image of a cone is a circle; a chord of it that sags by more than half the tolerance shows as a flat rim.
bool EdgeOracle::is_sagging_chord(const MappedPoint& a, const MappedPoint& b) const {
  for (std::size_t i = 0; i < region_.boundaries.size(); ++i)
    if (region_.boundaries[i].kind != Boundary::Kind::near_sphere && a.sides[i] == 0 && b.sides[i] == 0 &&
        glm::length(a.mapped.image) - 0.5 * glm::length(a.mapped.image + b.mapped.image) > 0.5 * options_.tolerance)
      return true;
  return false;
}

EdgeDecision EdgeOracle::decide(const MappedPoint& a, const MappedPoint& b) const {
  EdgeDecision decision;
  bool outside = false;
  decision.split = split_at_boundary(a, b, outside);
  if (outside || decision.split) return decision;
  if (std::min(*std::min_element(a.sides.begin(), a.sides.end()), *std::min_element(b.sides.begin(), b.sides.end())) < 0)
    return decision; // crosses within rounding of one end
  const double rho_a = glm::length(a.eye), rho_b = glm::length(b.eye);
  const double cosine = glm::dot(a.eye, b.eye) / (rho_a * rho_b);
  if (cosine < 0.5) {
    const Vec3 bisector = (a.eye * rho_b + b.eye * rho_a) / (rho_a + rho_b);
    decision.split = Split{rho_a / (rho_a + rho_b), locate(bisector)};
    return decision;
  }
  if (is_sagging_chord(a, b)) {
    decision.split = Split{0.5, locate(point_at(a.eye, b.eye, 0.5))};
    return decision;
  }
  if (glm::length(b.eye - a.eye) <= smallest_angle * std::min(rho_a, rho_b)) return decision;
  return split_by_error(a, b);
}

EdgeDecision EdgeOracle::split_by_error(const MappedPoint& a, const MappedPoint& b) const {
  const double tolerance = options_.tolerance;
  EdgeDecision decision;
  const EdgeBound bound = bound_.edge(a.eye, b.eye, a.mapped.weight, b.mapped.weight);
  decision.error = static_cast<float>(bound.error());
  decision.depth_error = static_cast<float>(bound.depth);
  // Beside a fold of the curve R' has no bound, and no length of edge would ever be certified: samples must do.
  const bool unbounded = !(bound.error(8) <= hopeless * tolerance);
  const bool deep_enough = unbounded || bound.depth <= options_.depth_tolerance;
  if (decision.error <= tolerance && deep_enough) return decision;

  // The midpoint comes first: where it is off by more than the tolerance it is the vertex that is needed.
  std::array<Vec3, 9> exact;
  exact[0] = homogeneous(a.mapped);
  exact[8] = homogeneous(b.mapped);
  const MappedPoint middle = locate(point_at(a.eye, b.eye, 0.5));
  const auto evaluate = [&](int eighth) {
    exact[eighth] = homogeneous(eighth == 4 ? map_point(middle.eye) : map_point(point_at(a.eye, b.eye, eighth / 8.0)));
    ++decision.evaluations;
    return glm::length(dehomogenise(exact[eighth]) - dehomogenise(interpolate(a.mapped, b.mapped, eighth / 8.0)));
  };
  decision.split = Split{0.5, middle};
  double worst = evaluate(4);
  if (worst > tolerance || !deep_enough) return decision;
  for (const int n : {4, 8}) {
    const int stride = 8 / n;
    for (int i = stride; i < 8; i += 2 * stride)
      if (worst <= tolerance) worst = std::max(worst, evaluate(i));
    if (worst > tolerance) return decision;
    if (unbounded) continue;
    double between = 0;
    for (int i = 0; i < 8; i += stride)
      between = std::max(between, segment_distance(interpolate(a.mapped, b.mapped, i / 8.0),
                                                   interpolate(a.mapped, b.mapped, (i + stride) / 8.0), exact[i], exact[i + stride]));
    decision.error = std::min(decision.error, static_cast<float>(between + bound.error(n)));
    if (decision.error <= tolerance) {
      decision.split.reset();
      return decision;
    }
    if (between + bound.error(2 * n) > tolerance) return decision; // more samples cannot help
  }
  if (unbounded && 2 * worst <= tolerance) {
    decision.split.reset();
    decision.error = static_cast<float>(worst);
    decision.certified = false;
  }
  return decision;
}

double EdgeOracle::diagonal_error(const MappedPoint& a, const MappedPoint& b) const {
  for (const MappedPoint* p : {&a, &b})
    if (*std::min_element(p->sides.begin(), p->sides.end()) < 0) return glm::length(b.eye - a.eye) * 1e100;
  return bound_.edge(a.eye, b.eye, a.mapped.weight, b.mapped.weight).error();
}

double EdgeOracle::interior_error(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& weights) const {
  const Vec3 drawn = homogeneous(a.mapped) * weights.x + homogeneous(b.mapped) * weights.y + homogeneous(c.mapped) * weights.z;
  const Mapped exact = map_point(a.eye * weights.x + b.eye * weights.y + c.eye * weights.z);
  return glm::length(dehomogenise(drawn) - exact.image);
}

} // namespace domewarp
