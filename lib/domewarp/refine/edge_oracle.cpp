// SPDX-License-Identifier: Apache-2.0
// Based on: the edge-local tests of DiagSplit (Fisher et al. 2009), the certificate max |e| <= max_i |e(i/n)| + B/n^2
// for an error with bounded second derivative, extended here to perspective-correct interpolation.
#include "domewarp/refine/edge_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

namespace domewarp {

namespace {

/// Edges shorter than this angle are never split: 1e-7 of an image is far below a pixel's thousandth.
constexpr double smallest_angle = 1e-9;
constexpr double hopeless = 64;        ///< an edge whose eighths still have this many tolerances of error
constexpr double widest_sampled = 0.05; ///< radians; a wider edge could hide something between seven samples

Vec3 homogeneous(const Mapped& m) { return Vec3(m.image * m.weight, m.weight); }

Vec2 dehomogenise(const Vec3& q) { return Vec2(q) / q.z; }

float rounded_up(double value) {
  const float f = static_cast<float>(value);
  return static_cast<double>(f) >= value ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
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
    : map_(map), region_(std::move(region)), options_(options), bound_(surface, branch, map.branch().theta_low, highest_angle(map.branch()), options.projection),
      rim_angle_(unnoticed_angle(surface, branch, options.tolerance)) {}

EdgeOracle EdgeOracle::relaxed(double factor) const {
  EdgeOracle oracle = *this;
  oracle.options_.tolerance *= factor;
  oracle.options_.face_tolerance *= factor;
  oracle.options_.depth_tolerance *= factor;
  oracle.rim_angle_ *= factor;
  return oracle;
}

Mapped EdgeOracle::map_point(const Vec3& eye) const {
  const RadialFactors factors = map_.factors(eye);
  const double rho = glm::length(eye);
  const double scale = factors.k / rho;
  return {Vec2(eye.x * scale, eye.y * scale), options_.projection == Projection::perspective ? rho * factors.g : 1.0};
}

MappedPoint EdgeOracle::locate(const Vec3& eye, int on) const {
  MappedPoint point{direction_of(eye), sides_of(region_, eye), {}};
  if (on >= 0) point.sides[on] = 0;
  if (*std::min_element(point.sides.begin(), point.sides.end()) >= 0) point.mapped = map_point(eye);
  return point;
}

std::optional<MappedPoint> EdgeOracle::middle(const MappedPoint& a, const MappedPoint& b) const {
  const Vec3 eye = point_at(a.eye, b.eye, 0.5);
  if (eye == a.eye || eye == b.eye) return std::nullopt;
  int on = -1;
  for (int i = 0; i < static_cast<int>(region_.boundaries.size()); ++i)
    if (a.sides[i] == 0 && b.sides[i] == 0) on = i;
  const MappedPoint point = locate(eye, on);
  if (*std::min_element(point.sides.begin(), point.sides.end()) < 0) return std::nullopt;
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

// The image of a cone is a circle; a chord of it that sags by more than the tolerance shows as a flat rim.
bool EdgeOracle::is_sagging_chord(const MappedPoint& a, const MappedPoint& b) const {
  for (std::size_t i = 0; i < region_.boundaries.size(); ++i)
    if (region_.boundaries[i].kind != Boundary::Kind::near_sphere && a.sides[i] == 0 && b.sides[i] == 0 &&
        glm::length(a.mapped.image) - 0.5 * glm::length(a.mapped.image + b.mapped.image) > options_.tolerance)
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

// Interpolated over exact depth at the midpoint, less 1.
double EdgeOracle::depth_deviation(const MappedPoint& a, const MappedPoint& b, const MappedPoint& middle) const {
  if (options_.projection == Projection::orthographic) return 0.5 * (a.rho + b.rho) / middle.rho - 1;
  return 0.5 * (a.mapped.weight + b.mapped.weight) / middle.mapped.weight - 1;
}

EdgeDecision EdgeOracle::split_by_error(const MappedPoint& a, const MappedPoint& b) const {
  EdgeDecision decision;
  const double wa = a.mapped.weight, wb = b.mapped.weight;
  const EdgeBend whole = bound_.edge(a, b, wa, wb);
  // Beside a fold of the curve R' has no bound, and no length of edge would ever be certified.
  if (!(whole.second / (8 * 64 * std::min(wa, wb)) <= hopeless * options_.tolerance)) return split_by_samples(a, b);
  double error = peak_error(0, 0, whole.second, wa, wb);
  decision.depth_error = rounded_up(whole.depth);
  decision.error = rounded_up(error);
  decision.arch = rounded_up(whole.second / (8 * std::min(wa, wb)));
  if (decision.arch <= options_.tolerance && whole.depth <= options_.depth_tolerance) return decision;

  // The midpoint is the vertex that a split needs, and its deviation is certain; the halves' bounds cover the rest.
  const MappedPoint middle = locate(point_at(a.eye, b.eye, 0.5));
  decision.evaluations = 1;
  decision.split = Split{0.5, middle};
  const double wm = 0.5 * (wa + wb);
  const double off = glm::length(wa * a.mapped.image + wb * b.mapped.image - 2 * wm * middle.mapped.image) / 2;
  const double depth_off = std::abs(depth_deviation(a, b, middle));
  if (off > options_.tolerance * wm || depth_off > options_.depth_tolerance) return decision;
  const EdgeBend first = bound_.edge(a, middle, wa, wm), second = bound_.edge(middle, b, wm, wb);
  error = std::min(error, std::max(peak_error(0, off, first.second, wa, wm), peak_error(off, 0, second.second, wm, wb)));
  const double depth = peak_error(0, depth_off, 8 * std::max(first.depth, second.depth), 1, 1) * (1 + depth_off);
  // (1 - t)(2 off + 8 (2 t - 1) second / 8) on the second half, and its mirror image, stay below the parabola.
  double arch = std::max(off, 0.5 * off + 0.25 * std::max(first.second, second.second)) / std::min(wa, wb);
  if (!(arch <= options_.tolerance)) {
    const double extent = off / wm + image_extent(a, middle, b);
    error = std::min(error, extent);
    if (extent <= options_.tolerance) arch = extent;
  }
  decision.error = rounded_up(error);
  decision.arch = std::min(decision.arch, rounded_up(arch));
  decision.depth_error = rounded_up(std::min(whole.depth, depth));
  if (decision.arch <= options_.tolerance && decision.depth_error <= options_.depth_tolerance) decision.split.reset();
  return decision.split && has_fold() ? split_by_samples(a, b) : decision;
}

// Kept when it is short and seven points are within half the tolerance, split at the midpoint otherwise.
EdgeDecision EdgeOracle::split_by_samples(const MappedPoint& a, const MappedPoint& b) const {
  EdgeDecision decision;
  decision.certified = false;
  const MappedPoint middle = locate(point_at(a.eye, b.eye, 0.5));
  const Vec3 from = homogeneous(a.mapped), to = homogeneous(b.mapped);
  double worst = 0;
  for (const int eighth : {4, 2, 6, 1, 3, 5, 7}) {
    const double t = eighth / 8.0;
    const Vec2 exact = eighth == 4 ? middle.mapped.image : map_point(point_at(a.eye, b.eye, t)).image;
    ++decision.evaluations;
    worst = std::max(worst, glm::length(dehomogenise(from * (1 - t) + to * t) - exact));
    if (2 * worst > options_.tolerance) break;
  }
  decision.error = decision.arch = rounded_up(worst);
  decision.depth_error = rounded_up(std::abs(depth_deviation(a, b, middle)));
  const bool wide = glm::length(b.eye - a.eye) > widest_sampled * std::min(a.rho, b.rho);
  if (wide || 2 * worst > options_.tolerance || decision.depth_error > options_.depth_tolerance) decision.split = Split{0.5, middle};
  return decision;
}

bool EdgeOracle::looks_good(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, std::size_t& evaluations) const {
  constexpr double third = 1.0 / 3.0;
  for (const Vec3& weights : {Vec3(third), Vec3(0.5, 0.25, 0.25), Vec3(0.25, 0.5, 0.25), Vec3(0.25, 0.25, 0.5)}) {
    ++evaluations;
    if (interior_error(a, b, c, weights) > options_.tolerance) return false;
  }
  return true;
}

// Beside a fold of the curve R' has no bound; but the image of an edge lies in the part of an annulus that its ends and
// its extreme angle span, and so do the chords of its halves. R is monotone over a branch.
double EdgeOracle::image_extent(const MappedPoint& a, const MappedPoint& m, const MappedPoint& b) const {
  const auto radius = [](const MappedPoint& p) { return glm::length(p.mapped.image); };
  auto [low, high] = std::minmax({radius(a), radius(m), radius(b)});
  if (const std::optional<double> t = extremum(Boundary{Boundary::Kind::high_cone}, a.eye, b.eye)) {
    const double extreme = glm::length(map_point(point_at(a.eye, b.eye, *t)).image);
    low = std::min(low, extreme);
    high = std::max(high, extreme);
  }
  const Vec2 p = a.mapped.image, q = b.mapped.image;
  const double turn = std::atan2(std::abs(p.x * q.y - p.y * q.x), glm::dot(p, q));
  return high - low + high * turn;
}

double EdgeOracle::diagonal_error(const MappedPoint& a, const MappedPoint& b) const {
  for (const MappedPoint* p : {&a, &b})
    if (*std::min_element(p->sides.begin(), p->sides.end()) < 0) return glm::length(b.eye - a.eye) * 1e100;
  const double wa = a.mapped.weight, wb = b.mapped.weight;
  return peak_error(0, 0, bound_.edge(a, b, wa, wb).second, wa, wb);
}

// Two sides have arches, and on every segment parallel to the third the second derivative is that along it. Three such
// bounds are open; the side with the lowest arch promises the least.
bool EdgeOracle::is_good(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& arches, std::size_t& evaluations) const {
  if (arches.y < arches.x && arches.y <= arches.z) return is_good(b, c, a, {arches.y, arches.z, arches.x}, evaluations);
  if (arches.z < arches.x) return is_good(c, a, b, {arches.z, arches.x, arches.y}, evaluations);
  const Vec3 weights(a.mapped.weight, b.mapped.weight, c.mapped.weight);
  const double least = 8 * std::min({weights.x, weights.y, weights.z});
  const double inner = bound_.face(a, b, c, weights, b.eye - a.eye, weights.y - weights.x) / least;
  if (peak_face(Vec3(0), {inner, arches.y, arches.z}) <= options_.face_tolerance) return true;
  if (is_good_across(a, b, c, arches)) return true;
  ++evaluations;
  return is_good_around(a, b, c, arches);
}

// Every point lies on a segment parallel to a height, between the side it stands on and one of the others: this proves
// flat faces good, whose sides leave their interior next to nothing.
bool EdgeOracle::is_good_across(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& arches) const {
  if (arches.y > arches.x && arches.y >= arches.z) return is_good_across(b, c, a, {arches.y, arches.z, arches.x});
  if (arches.z > arches.x) return is_good_across(c, a, b, {arches.z, arches.x, arches.y});
  const Vec3 weights(a.mapped.weight, b.mapped.weight, c.mapped.weight), d = b.eye - a.eye;
  const double foot = std::clamp(glm::dot(c.eye - a.eye, d) / glm::dot(d, d), 0.0, 1.0);
  const double least = 8 * std::min({weights.x, weights.y, weights.z});
  const double second = bound_.face(a, b, c, weights, c.eye - point_at(a.eye, b.eye, foot), weights.z - (1 - foot) * weights.x - foot * weights.y);
  return arches.x + second / least <= options_.face_tolerance;
}

// The deviation at the centroid is certain. Towards it the face falls into three, whose spokes have arches.
bool EdgeOracle::is_good_around(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& arches) const {
  const std::array<const MappedPoint*, 3> corner{&a, &b, &c};
  constexpr double third = 1.0 / 3.0;
  const double off = interior_error(a, b, c, Vec3(third));
  if (off > options_.face_tolerance) return false;
  const Direction centre = direction_of((a.eye + b.eye + c.eye) * third);
  const double weight = (a.mapped.weight + b.mapped.weight + c.mapped.weight) * third;
  std::array<double, 3> spoke;
  for (int k = 0; k < 3; ++k) {
    const double w = corner[k]->mapped.weight;
    spoke[k] = bound_.edge(*corner[k], centre, w, weight).second / (8 * std::min(w, weight));
  }
  for (int k = 0; k < 3; ++k) {
    const MappedPoint &p = *corner[k], &q = *corner[(k + 1) % 3];
    const double wp = p.mapped.weight, wq = q.mapped.weight, least = 8 * std::min({wp, wq, weight});
    const bool along_q = spoke[(k + 1) % 3] < spoke[k];
    const MappedPoint& r = along_q ? q : p;
    const double inner = bound_.face(p, q, centre, {wp, wq, weight}, centre.eye - r.eye, weight - r.mapped.weight) / least;
    const Vec3 sides = along_q ? Vec3(arches[k], inner, spoke[k]) : Vec3(arches[k], spoke[(k + 1) % 3], inner);
    if (peak_face({0, 0, off}, sides) > options_.face_tolerance) return false;
  }
  return true;
}

double EdgeOracle::interior_error(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& weights) const {
  const Vec3 drawn = homogeneous(a.mapped) * weights.x + homogeneous(b.mapped) * weights.y + homogeneous(c.mapped) * weights.z;
  const Mapped exact = map_point(a.eye * weights.x + b.eye * weights.y + c.eye * weights.z);
  return glm::length(dehomogenise(drawn) - exact.image);
}

} // namespace domewarp
