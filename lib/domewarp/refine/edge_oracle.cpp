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

#include "domewarp/core/rounding.h"
#include "domewarp/transform/radial_table.h"

namespace domewarp {

namespace {

/// Edges shorter than this angle are never split: 1e-7 of an image is far below a pixel's thousandth.
constexpr double smallest_angle = 1e-9;
constexpr double hopeless = 64;        ///< an edge whose eighths still have this many tolerances of error
constexpr double least_left = 0.25;    ///< of what a bound leaves open, where pieces half as long are hardly ever better
constexpr double spare = 1.1;          ///< by how much more than the middle's deviation the greatest one is taken to be
constexpr double most_counted = 64;    ///< pieces; what needs more is far from knowing how many
constexpr double slide_share = 0.7;    ///< of its tolerance that a sliding edge may take up: the faces beside it need more
constexpr double slide_depth_share = 0.6; ///< the same of the depth, of which faces take a third more than their sides
constexpr double widest_asked = 8;     ///< image units: twice the picture's diagonal, and once more for halves that are not halves in the image
constexpr double widest_sampled = 0.05; ///< radians; a wider edge could hide something between seven samples

/// The angle that moves the rim by a tenth of the tolerance.
double unnoticed_angle(const BranchMap& map, double tolerance) {
  constexpr double steepest = 1e4;
  const bool has_fold = map.branch().fold_low || map.branch().fold_high;
  return 0.1 * tolerance / (has_fold ? steepest : std::clamp(std::max(map.end_slope(false), map.end_slope(true)), 1.0, steepest));
}

} // namespace

EdgeOracle::EdgeOracle(const Surface& surface, std::size_t branch, const BranchMap& map, VisibleRegion region,
                       const OracleOptions& options)
    : map_(map), region_(std::move(region)), options_(options), bound_(surface, branch, map.branch().theta_low, highest_angle(map.branch()), options.projection),
      rim_angle_(unnoticed_angle(map, options.tolerance)), low_slope_(map.end_slope(false)), high_slope_(map.end_slope(true)) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  u_low_ = -infinity;
  u_high_ = infinity;
  nearest_ = 0;
  for (const Boundary& boundary : region_.boundaries) {
    const double u = half_angle_index(boundary.sine, boundary.cosine, 1);
    if (boundary.kind == Boundary::Kind::low_cone) u_low_ = u;
    if (boundary.kind == Boundary::Kind::high_cone) u_high_ = u;
    if (boundary.kind == Boundary::Kind::near_sphere) nearest_ = boundary.radius;
  }
  if (options.criterion) most_asked_ = static_cast<int>(std::clamp(std::ceil(std::log2(widest_asked / options.criterion_length)), 0.0, 255.0));
}

EdgeOracle EdgeOracle::relaxed(double factor) const {
  EdgeOracle oracle = *this;
  oracle.options_.tolerance *= factor;
  oracle.options_.face_tolerance *= factor;
  oracle.options_.texture_tolerance *= factor;
  oracle.options_.plain_tolerance *= factor;
  oracle.options_.depth_tolerance *= factor;
  oracle.options_.face_depth_tolerance *= factor;
  oracle.options_.turned_thickness *= factor;
  oracle.options_.criterion_length *= factor;
  oracle.rim_angle_ *= factor;
  return oracle;
}

// With L the longest side, every point is within the angle L / (nearest - L) of a corner, and within u_margin of that in u; for
// this to stay within `room`, L (0.51 + room) < room * nearest. Sides of such figures take up less than 45 degrees.
bool EdgeOracle::is_well_inside(double longest2, double u_low, double u_high, double nearest) const {
  const double room = std::min({1.0, u_high_ - u_high, u_low - u_low_}), least = nearest - nearest_;
  if (!(room > 0 && least > 0)) return false;
  const double reach = room * nearest, share = u_margin(1) + room;
  return share * share * longest2 < reach * reach && longest2 < least * least;
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

// What is beyond a rim's chord is gone: its middle is on the rim too, for whoever looks for open edges, unless it is beyond the
// rim itself. Then it is not drawn, and what is cut off there follows the rim more closely.
std::optional<MappedPoint> EdgeOracle::middle(const MappedPoint& a, const MappedPoint& b) const {
  const Vec3 eye = point_at(a.eye, b.eye, 0.5);
  if (eye == a.eye || eye == b.eye) return std::nullopt;
  const Sides sides = sides_of(region_, eye);
  bool is_chord = false;
  int on = -1;
  for (int i = 0; i < static_cast<int>(region_.boundaries.size()); ++i) {
    if (a.sides[i] != 0 || b.sides[i] != 0) continue;
    is_chord = true;
    if (sides[i] > 0 || region_.boundaries[i].kind == Boundary::Kind::near_sphere) on = i;
  }
  if (!is_chord && *std::min_element(sides.begin(), sides.end()) < 0) return std::nullopt;
  MappedPoint point = locate(eye, on);
  point.asked = std::max(a.asked, b.asked);
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
  // The near sphere, which is the last, first: what a cone shows of a face that touches the eye narrows towards it, whoever
  // sees the side that passes through.
  for (int i = static_cast<int>(region_.boundaries.size()) - 1; i >= 0; --i) {
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

// The image of a cone is a circle; a chord of it that sags by more than the tolerance shows as a flat rim. Its points lie
// beyond the cone where that opens by more than 90 degrees, or is the inner end of a branch: they belong farther out still.
bool EdgeOracle::is_sagging_chord(const MappedPoint& a, const MappedPoint& b) const {
  for (std::size_t i = 0; i < region_.boundaries.size(); ++i) {
    const Boundary& boundary = region_.boundaries[i];
    if (boundary.kind == Boundary::Kind::near_sphere || a.sides[i] != 0 || b.sides[i] != 0) continue;
    const bool is_high = boundary.kind == Boundary::Kind::high_cone, is_outer = is_high == (orientation() > 0);
    const Vec3 middle = point_at(a.eye, b.eye, 0.5);
    const double beyond = std::max(0.0, -signed_distance(boundary, middle) / glm::length(middle)) * (is_high ? high_slope_ : low_slope_);
    const double sag = glm::length(a.mapped.image) - 0.5 * glm::length(a.mapped.image + b.mapped.image);
    if ((is_outer ? sag + beyond : std::max(sag, beyond)) > options_.tolerance) return true;
  }
  return false;
}

EdgeDecision EdgeOracle::decide(const MappedPoint& a, const MappedPoint& b, const EdgeContext& context) const {
  const Vec3 d = b.eye - a.eye;
  const double length2 = glm::dot(d, d), nearest = std::min(a.rho, b.rho);
  const bool is_tiny = length2 <= smallest_angle * smallest_angle * nearest * nearest;
  if (is_well_inside(length2, a, b)) return is_tiny ? EdgeDecision{} : split_by_criterion(split_by_error(a, b, context), a, b);
  EdgeDecision decision;
  bool outside = false;
  decision.split = split_at_boundary(a, b, outside);
  if (outside || decision.split) return decision;
  if (std::min(*std::min_element(a.sides.begin(), a.sides.end()), *std::min_element(b.sides.begin(), b.sides.end())) < 0)
    return decision; // crosses within rounding of one end
  if (glm::dot(a.eye, b.eye) < 0.5 * a.rho * b.rho) {
    const Vec3 bisector = (a.eye * b.rho + b.eye * a.rho) / (a.rho + b.rho);
    decision.split = Split{a.rho / (a.rho + b.rho), locate(bisector)};
    return decision;
  }
  if (is_sagging_chord(a, b)) {
    decision.split = Split{0.5, locate(point_at(a.eye, b.eye, 0.5))};
    return decision;
  }
  if (is_tiny) return decision;
  return split_by_criterion(split_by_error(a, b, context), a, b);
}

// A jump along the side of a sliver can ask for ever for vertices ever nearer to that side. Halving ends sooner, so
// points remember how many of these splits led to them.
EdgeDecision EdgeOracle::split_by_criterion(EdgeDecision decision, const MappedPoint& a, const MappedPoint& b) const {
  if (!decision.split && most_asked_ == 0) return decision;
  const std::uint8_t asked = std::max(a.asked, b.asked);
  const auto is_asked = [&] {
    return asked < most_asked_ && glm::length(b.mapped.image - a.mapped.image) > options_.criterion_length && options_.criterion(a, b);
  };
  if (decision.split) {
    decision.split->point.asked = asked;
  } else if (is_asked()) {
    decision.split = Split{0.5, locate(point_at(a.eye, b.eye, 0.5))};
    decision.split->point.asked = asked + 1;
    ++decision.evaluations;
  }
  return decision;
}

DrawnPoint EdgeOracle::drawn(const MappedPoint& p) const {
  return {p, p.mapped.image * p.mapped.weight, p.mapped.weight, options_.projection == Projection::perspective ? p.mapped.weight : p.rho, 0, 0, p.mapped};
}

DrawnPoint EdgeOracle::between(const DrawnPoint& p, const DrawnPoint& q) const {
  DrawnPoint middle = halfway(p, q);
  const Mapped exact = middle.exact = map_point(middle.eye);
  middle.off = glm::length(middle.image - middle.weight * exact.image);
  middle.depth_off = std::abs(middle.depth / (options_.projection == Projection::perspective ? exact.weight : middle.rho) - 1);
  return middle;
}

MappedPoint EdgeOracle::vertex_at(const DrawnPoint& p) const { return {p, sides_of(region_, p.eye), p.exact}; }

DrawnPoint halfway(const DrawnPoint& p, const DrawnPoint& q) {
  return {direction_of(point_at(p.eye, q.eye, 0.5)), 0.5 * (p.image + q.image), 0.5 * (p.weight + q.weight), 0.5 * (p.depth + q.depth), 0, 0, {}};
}

EdgeOracle::Piece EdgeOracle::piece(const DrawnPoint& p, const DrawnPoint& q) const {
  const EdgeBend bend = bound_.edge(p, q, p.weight, q.weight);
  const double depth = peak_error(p.depth_off, q.depth_off, 8 * bend.depth, 1, 1) * (1 + std::max(p.depth_off, q.depth_off));
  return {bend.second, peak_error(p.off, q.off, bend.second, p.weight, q.weight), depth};
}

EdgeDecision EdgeOracle::split_by_error(const MappedPoint& a, const MappedPoint& b, const EdgeContext& context) const {
  EdgeDecision decision;
  const DrawnPoint from = drawn(a), to = drawn(b);
  const EdgeBend whole = context.known != nullptr ? *context.known : bound_.edge(a, b, from.weight, to.weight);
  const double least = std::min(from.weight, to.weight);
  const InnerPlane* inside = share_boundary(a.sides, b.sides) ? nullptr : context.inside; // a chord is outline
  const Range span = inside != nullptr ? bound_.edge_span(a, b) : Range{};
  const auto total_depth = [&](double error, double depth_error) { return slid_depth(span, std::max(a.rho, b.rho), error, depth_error, *inside); };
  const auto is_good = [&] {
    if (decision.error <= options_.tolerance && decision.depth_error <= options_.depth_tolerance) return true;
    if (inside == nullptr || decision.error > slide_share * inside->tolerance) return false;
    decision.slide_depth = rounded_up(total_depth(decision.error, decision.depth_error));
    return decision.slides = decision.slide_depth <= slide_depth_share * options_.face_depth_tolerance;
  };
  decision.error = rounded_up(peak_error(0, 0, whole.second, from.weight, to.weight));
  decision.depth_error = rounded_up(whole.depth);
  decision.arch = rounded_up(whole.second / (8 * least));
  if (is_good()) return decision;
  const EdgeBend brief = bound_.short_segments({small_angle(glm::length(b.eye - a.eye), std::min(a.rho, b.rho)), std::min(a.u, b.u), std::max(a.u, b.u), least, std::max(from.weight, to.weight)});
  if (brief.second / (8 * least) <= options_.tolerance && brief.depth <= options_.depth_tolerance) {
    decision.error = std::min(decision.error, rounded_up(brief.second / (8 * least)));
    decision.arch = std::min(decision.arch, rounded_up(brief.second / (8 * least)));
    decision.depth_error = std::min(decision.depth_error, rounded_up(brief.depth));
    return decision;
  }
  // Beside a fold of the curve R' has no bound, and no length of edge would ever be certified.
  if (!(whole.second / (8 * 64 * least) <= hopeless * options_.tolerance)) return split_by_samples(a, b);

  // What the middle is off by is certain; the bounds of the pieces cover the rest.
  const DrawnPoint middle = between(from, to);
  decision.evaluations = 1;
  const double off = middle.off / middle.weight;
  decision.middle = rounded_up(off);
  if (off > options_.tolerance || middle.depth_off > options_.depth_tolerance) {
    const double excess = inside == nullptr ? std::max(off / options_.tolerance, middle.depth_off / options_.depth_tolerance)
                                            : std::max(off / (slide_share * inside->tolerance), total_depth(off, middle.depth_off) / (slide_depth_share * options_.face_depth_tolerance));
    if (excess > 1) {
      decision.excess = static_cast<float>(excess);
      decision.split = share_out(a, b, middle, excess, decision.evaluations);
      return decision;
    }
  }
  const Piece first = piece(from, middle), second = piece(middle, to);
  const auto lower = [&](double error, double depth, double arch) {
    decision.error = std::min(decision.error, rounded_up(error));
    decision.depth_error = std::min(decision.depth_error, rounded_up(depth));
    decision.arch = std::min(decision.arch, rounded_up(arch / least));
  };
  // A piece is off by at most its ends' deviations, interpolated, and u (1 - u) / 2 of its second derivative; this over
  // t (1 - t) is greatest at an end of the piece.
  lower(std::max(first.error, second.error), std::max(first.depth, second.depth),
        std::max(middle.off, 0.5 * middle.off + 0.25 * std::max(first.second, second.second)));
  if (is_good()) return decision;

  const auto halve = [&] {
    decision.excess = static_cast<float>(std::max(decision.error / options_.tolerance, decision.depth_error / options_.depth_tolerance));
    decision.split = Split{0.5, vertex_at(middle)};
    return decision;
  };
  if (off + least_left * (decision.error - off) > options_.tolerance && inside == nullptr && !has_fold()) return halve();
  decision.evaluations += 2;
  double error = 0, depth = 0, arch = 0;
  for (const DrawnPoint* end : {&from, &to}) {
    const DrawnPoint quarter = between(*end, middle);
    const Piece outer = piece(*end, quarter), inner = piece(quarter, middle);
    error = std::max({error, outer.error, inner.error});
    depth = std::max({depth, outer.depth, inner.depth});
    arch = std::max({arch, quarter.off + outer.second / 2, (quarter.off + inner.second / 8) * 4 / 3, middle.off + inner.second / 8});
  }
  lower(error, depth, arch);
  if (is_good()) return decision;

  const double extent = middle.off / middle.weight + image_extent(a, b, middle.exact.image);
  if (extent <= options_.tolerance) decision.error = std::min(decision.error, rounded_up(extent)); // beside an end it may rise faster than any arch
  if (is_good()) return decision;
  if (has_fold()) return split_by_samples(a, b);
  return halve();
}

// Halving alone makes 2^k pieces where n would do: an edge that needs n is split at floor(n / 2) / n of its angle.
Split EdgeOracle::share_out(const MappedPoint& a, const MappedPoint& b, const DrawnPoint& middle, double excess, std::uint8_t& evaluations) const {
  const double pieces = std::ceil(std::sqrt(excess * spare));
  if (!(pieces > 2 && pieces <= most_counted)) return {0.5, vertex_at(middle)};
  const double share = std::floor(pieces / 2) / pieces;
  const double angle = std::atan2(glm::length(glm::cross(a.eye, b.eye)), glm::dot(a.eye, b.eye));
  const double p = a.rho * std::sin(share * angle), q = b.rho * std::sin((1 - share) * angle), t = p / (p + q);
  ++evaluations;
  return {t, locate(point_at(a.eye, b.eye, t))};
}

// Kept when it is short and seven points are within half the tolerance, split at the midpoint otherwise.
EdgeDecision EdgeOracle::split_by_samples(const MappedPoint& a, const MappedPoint& b) const {
  EdgeDecision decision;
  decision.certified = false;
  // Chords of a rim may be beyond it, so the middle is mapped whatever its sides: left out, its depth would be wrong.
  const DrawnPoint middle = between(drawn(a), drawn(b));
  const Vec3 from = homogeneous(a.mapped), to = homogeneous(b.mapped);
  double worst = 0;
  for (const int eighth : {4, 2, 6, 1, 3, 5, 7}) {
    const double t = eighth / 8.0;
    const Vec2 exact = eighth == 4 ? middle.exact.image : map_point(point_at(a.eye, b.eye, t)).image;
    ++decision.evaluations;
    worst = std::max(worst, glm::length(dehomogenise(from * (1 - t) + to * t) - exact));
    if (2 * worst > options_.tolerance) break;
  }
  decision.error = decision.arch = rounded_up(worst);
  decision.depth_error = rounded_up(middle.depth_off);
  const bool wide = glm::length(b.eye - a.eye) > widest_sampled * std::min(a.rho, b.rho);
  if (wide || 2 * worst > options_.tolerance || decision.depth_error > options_.depth_tolerance) decision.split = Split{0.5, vertex_at(middle)};
  return decision;
}

// Beside a fold of the curve R' has no bound; but the image of an edge lies in the part of an annulus that its ends and
// its extreme angle span, and so do the chords of its halves. R is monotone over a branch.
double EdgeOracle::image_extent(const MappedPoint& a, const MappedPoint& b, const Vec2& middle) const {
  auto [low, high] = std::minmax({glm::length(a.mapped.image), glm::length(middle), glm::length(b.mapped.image)});
  if (const std::optional<double> t = extremum(Boundary{Boundary::Kind::high_cone}, a.eye, b.eye)) {
    const double extreme = glm::length(map_point(point_at(a.eye, b.eye, *t)).image);
    low = std::min(low, extreme);
    high = std::max(high, extreme);
  }
  const Vec2 p = a.mapped.image, q = b.mapped.image;
  const double turn = std::atan2(std::abs(p.x * q.y - p.y * q.x), glm::dot(p, q));
  return high - low + high * turn;
}

DiagonalBound EdgeOracle::diagonal(const MappedPoint& a, const MappedPoint& b) const {
  for (const MappedPoint* p : {&a, &b})
    if (*std::min_element(p->sides.begin(), p->sides.end()) < 0) return {glm::length(b.eye - a.eye) * 1e100, std::nullopt};
  // Beside a fold there is no bound: an edge is at most about as far off as it is long, and less than one to the outside.
  const double wa = a.mapped.weight, wb = b.mapped.weight;
  const EdgeBend bend = bound_.edge(a, b, wa, wb);
  return {std::min(peak_error(0, 0, bend.second, wa, wb), glm::length(a.mapped.image - b.mapped.image)), bend};
}

} // namespace domewarp
