// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "domewarp/profile/analysis.h"
#include "domewarp/profile/half_angle.h"
#include "domewarp/profile/refuse.h"
#include "domewarp/profile/surface_parts.h"

namespace domewarp {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Limit {
  double radius;
  RadiusLimit reason;
};

struct Trace {
  Limit limit;
  double hidden_from = infinity;
};

void require_positive(const char* option, double value) {
  if (value > 0 && std::isfinite(value)) return;
  refuse(option, "must be greater than 0 and finite, got " + to_text(value));
}

void check(const SurfaceOptions& options, double screen_radius) {
  const int given = int(!options.curve.empty()) + int(options.lens.has_value()) + int(!options.profile.empty());
  if (given == 0) refuse("--curve", "one of --curve, --lens and --profile is needed, and an empty curve is none");
  if (given > 1) refuse("--curve", "only one of --curve, --lens and --profile can be given");
  if (options.rmax) require_positive("--rmax", *options.rmax);
  if (options.projector) require_positive("--projector", *options.projector);
  if (!(options.extension_deg >= 0 && options.extension_deg <= 180))
    refuse("--extension", "must be from 0 to 180 degrees, got " + std::to_string(options.extension_deg));
  require_positive("--size", screen_radius);
}

Limit picture_limit(const SurfaceOptions& options, double screen_radius) {
  if (options.rmax && *options.rmax < screen_radius) return {*options.rmax, RadiusLimit::user};
  return {screen_radius, RadiusLimit::screen};
}

// The curve is followed that many times further out than the picture reaches, before compensation.
constexpr double reach = 1024;

const char* source(const SurfaceOptions& options) { return options.profile.empty() ? "--curve" : "--profile"; }

// The ends of the last pair of neighbouring numbers in [0, hi] of which only the upper one `exceeds`.
template <typename Predicate>
std::pair<double, double> bisect(const Predicate& exceeds, double hi) {
  double lo = 0;
  for (double middle = 0.5 * hi; middle > lo && middle < hi; middle = lo + 0.5 * (hi - lo))
    (exceeds(middle) ? hi : lo) = middle;
  return {lo, hi};
}

// How far along the curve the picture goes; `picture` is in image units, the result in the curve's.
Trace trace_limit(const Curve& curve, double distance, const Limit& picture) {
  const bool compensated = std::isfinite(distance);
  double window = picture.radius;
  for (;; window *= 4) {
    double end = find_domain_end(curve, window);
    RadiusLimit reason = end < window ? RadiusLimit::domain : picture.reason;
    if (!compensated) return {{end, reason}};
    const std::vector<double> turns = find_folds(curve, end, distance);
    const double hidden = turns.empty() ? infinity : turns.front();
    if (hidden < end) {
      end = hidden;
      reason = RadiusLimit::projector;
    }
    // True where the compensated radius exceeds the picture's, also behind its pole at f = -distance.
    const auto exceeds = [&](double r) { return r * distance >= picture.radius * (evaluate(curve, r) + distance); };
    if (exceeds(end)) return {{bisect(exceeds, end).first, picture.reason}, hidden};
    if (reason != picture.reason) return {{end, reason}, hidden};
    if (window > reach * picture.radius) return {{end, RadiusLimit::projector}, hidden};
  }
}

void check_start(const SurfaceParts& parts) {
  const double start = evaluate(parts.curve, 0);
  if (std::abs(start) <= 1e-12)
    refuse(source(parts.options), "f(0) = " + to_text(start) + " puts the eye on the surface");
  if (start + parts.distance <= 0)
    refuse("--projector",
           "the surface starts at z = " + to_text(start) + ", behind the projector at " + to_text(-parts.distance));
}

Branch make_branch(const Span& span, double distance) {
  Branch branch{span.theta_at_low, span.theta_at_high, compensate(distance, span.r_low, span.z_low),
                compensate(distance, span.r_high, span.z_high), span.orientation};
  if (span.orientation < 0) {
    std::swap(branch.theta_low, branch.theta_high);
    std::swap(branch.radius_low, branch.radius_high);
  }
  return branch;
}

double angle_of(const Curve& curve, double r) { return std::atan2(r, evaluate(curve, r)); }

double angle_of(const QuadPoint& p) { return static_cast<double>(atan2(p.r, p.z)); }

Span make_span(const QuadPoint& low, const QuadPoint& high) {
  const auto rounded = [](const Quad& x) { return static_cast<double>(x); };
  Span span{rounded(low.r), rounded(high.r), rounded(low.z), rounded(high.z), angle_of(low), angle_of(high), 1, low, high};
  if (span.theta_at_high < span.theta_at_low) span.orientation = -1;
  span.index_at_low = half_angle_index(std::sin(span.theta_at_low), std::cos(span.theta_at_low), 1);
  span.index_at_high = half_angle_index(std::sin(span.theta_at_high), std::cos(span.theta_at_high), 1);
  return span;
}

std::vector<double> joint_angles(const Curve& curve, const std::vector<double>& kinks, const Span& span) {
  std::vector<double> angles;
  for (const double kink : kinks)
    if (kink > span.r_low && kink < span.r_high) angles.push_back(angle_of(curve, kink));
  std::sort(angles.begin(), angles.end());
  return angles;
}

// Slopes this large are the rounding of the place where the tangent is vertical.
constexpr double steepest = 1e7;

KinkKind kind_of(const Curve& curve, double r) {
  if (curve.measured) return KinkKind::joint;
  const auto steepness = [&](double at) { return std::abs(differentiate(curve, at).d); };
  const double most = std::max(steepness(std::nextafter(r, 0)), steepness(std::nextafter(r, infinity)));
  return most < steepest ? KinkKind::corner : KinkKind::vertical_tangent;
}

std::vector<Kink> describe_kinks(const SurfaceParts& parts, const std::vector<double>& radii) {
  std::vector<Kink> kinks;
  for (const double r : radii) {
    const double z = evaluate(parts.curve, r);
    kinks.push_back({r, z, compensate(parts.distance, r, z), std::atan2(r, z), kind_of(parts.curve, r)});
  }
  return kinks;
}

// One branch for each stretch between folds; stretches too short to hold a direction are dropped.
void add_branches(SurfaceParts& parts, const std::vector<QuadPoint>& ends, const std::vector<double>& kinks) {
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    Span span = make_span(ends[i], ends[i + 1]);
    if (std::abs(span.theta_at_high - span.theta_at_low) < 1e-12) continue;
    tabulate_guesses(parts.curve, span);
    Branch branch = make_branch(span, parts.distance);
    const bool inner = i > 0, outer = i + 2 < ends.size() || parts.limit == RadiusLimit::fold;
    branch.fold_low = span.orientation > 0 ? inner : outer;
    branch.fold_high = span.orientation > 0 ? outer : inner;
    parts.spans.push_back(span);
    parts.branches.push_back(branch);
    parts.joints.push_back(joint_angles(parts.curve, kinks, span));
  }
  if (parts.branches.empty())
    refuse(source(parts.options), "the surface shows nothing within an image radius of " + to_text(parts.r_max));
}

// The direction in which the surface goes on after its last branch; none where that ends in a fold.
QuadPoint rim_tangent(const SurfaceParts& parts) {
  const Span& last = parts.spans.back();
  const Branch& branch = parts.branches.back();
  if (last.orientation > 0 ? branch.fold_high : branch.fold_low) return {0, 0};
  Quad slope = differentiate(parts.curve, last.high.r).d;
  if (isnan(slope)) slope = differentiate(parts.curve, last.r_high * (1 - 1e-12)).d;
  if (abs(slope) > steepest) return {0, slope > 0 ? 1 : -1};
  return {1, slope};
}

SurfaceRim curve_rim(const SurfaceParts& parts) {
  const Span& last = parts.spans.back();
  const Vec2 tangent(static_cast<double>(parts.rim_tangent.r), static_cast<double>(parts.rim_tangent.z));
  const double length = std::max(std::hypot(tangent.x, tangent.y), 1.0); // 0 at a fold
  return {{last.r_high, last.z_high}, tangent / length};
}

// The end of the visible part to 30 digits.
QuadPoint refine_end(const SurfaceParts& parts, const Limit& end, const Limit& picture) {
  const bool compensated = std::isfinite(parts.distance);
  if (end.reason == RadiusLimit::domain) return refine_domain_end(parts.curve, end.radius);
  if (end.reason == RadiusLimit::fold) return refine_fold(parts.curve, end.radius, 0);
  if (end.reason == picture.reason && compensated)
    return refine_picture_end(parts.curve, end.radius, parts.distance, picture.radius);
  if (end.radius == parts.hidden_from) return refine_fold(parts.curve, end.radius, parts.distance);
  return point_on(parts.curve, end.radius);
}

// Whether a corner of the curve is a fold as well.
bool is_among(const std::vector<double>& folds, double r, double tolerance) {
  return std::any_of(folds.begin(), folds.end(), [&](double fold) { return std::abs(fold - r) <= tolerance; });
}

void build_curve(SurfaceParts& parts, const Limit& picture) {
  const SurfaceOptions& options = parts.options;
  parts.curve = options.profile.empty() ? make_curve(options.curve) : make_curve(options.profile, options.profile_name);
  check_start(parts);
  const Trace traced = trace_limit(parts.curve, parts.distance, picture);
  parts.hidden_from = traced.hidden_from;
  auto [end, reason] = traced.limit;
  if (!(end > 0)) refuse(source(options), "f(r) is not defined beyond r = 0");
  std::vector<double> folds = find_folds(parts.curve, end, 0);
  if (!folds.empty() && evaluate(parts.curve, 0) < 0)
    refuse(source(options), "f(0) = " + to_text(evaluate(parts.curve, 0)) +
                                " is behind the eye and the view angle turns at r = " + to_text(folds.front()));
  if (!folds.empty() && options.branches == BranchChoice::first) {
    end = folds.front();
    reason = RadiusLimit::fold;
    folds.clear();
  }
  parts.limit = reason;
  const bool by_picture = reason == picture.reason;
  parts.r_max = by_picture ? picture.radius : compensate(parts.distance, end, evaluate(parts.curve, end));
  std::vector<double> kinks = find_kinks(parts.curve, end);
  parts.kinks = describe_kinks(parts, kinks);
  std::erase_if(kinks, [&](double r) { return is_among(folds, r, 1e-12 * end); });
  std::vector<QuadPoint> ends{point_on(parts.curve, 0)};
  for (const double fold : folds) ends.push_back(refine_fold(parts.curve, fold, 0));
  ends.push_back(refine_end(parts, {end, reason}, picture));
  add_branches(parts, ends, kinks);
  // The same number, whichever way it was rounded.
  Branch& last = parts.branches.back();
  if (parts.spans.back().r_high == end) (last.orientation > 0 ? last.radius_high : last.radius_low) = parts.r_max;
  parts.rim_tangent = rim_tangent(parts);
  parts.rim = curve_rim(parts);
}

// The compensated radius rises with theta up to its pole: every lens's z falls as theta grows.
double lens_end(const LensForm& lens, double distance, double picture_radius) {
  const auto exceeds = [&](double theta) {
    const MeridianJet m = lens_meridian(lens, theta);
    return std::isinf(distance) ? m.r.r >= picture_radius : m.r.r * distance >= picture_radius * (m.z.r + distance);
  };
  return exceeds(lens.half_fov) ? bisect(exceeds, lens.half_fov).second : lens.half_fov;
}

void build_lens(SurfaceParts& parts, const Limit& picture) {
  parts.lens = make_lens(*parts.options.lens, parts.options.fov_deg);
  const double end = lens_end(*parts.lens, parts.distance, picture.radius);
  const bool whole = end == parts.lens->half_fov;
  parts.limit = whole ? RadiusLimit::lens : picture.reason;
  const MeridianJet m = lens_meridian(*parts.lens, end);
  parts.r_max = !whole ? picture.radius : std::isinf(parts.distance) ? 1 : compensate(parts.distance, m.r.r, m.z.r);
  parts.branches = {{0, end, 0, parts.r_max, 1}};
  const SurfaceOptions& options = parts.options;
  const LensEnd exact =
      refine_lens_end(*options.lens, options.fov_deg, end, parts.distance, whole ? infinity : picture.radius);
  parts.spans = {{0, m.r.r, 0, m.z.r, 0, end, 1, {0, 1}, exact.point}};
  parts.joints = {{}};
  parts.rim_tangent = exact.tangent;
  const double length = std::hypot(m.r.dr, m.z.dr);
  parts.rim = {{m.r.r, m.z.r}, {m.r.dr / length, m.z.dr / length}};
}

void round_rim(SurfaceParts& parts) {
  const QuadPoint rim = parts.spans.back().high, tangent = parts.rim_tangent;
  const Quad length = sqrt(tangent.r * tangent.r + tangent.z * tangent.z);
  if (length == 0) return;
  parts.rim_slope = {static_cast<double>(tangent.r / length), static_cast<double>(tangent.z / length)};
  parts.rim_moment = static_cast<double>((rim.z * tangent.r - rim.r * tangent.z) / length);
}

} // namespace

Surface::Surface(const SurfaceOptions& options, double screen_radius) {
  check(options, screen_radius);
  const auto parts = std::make_shared<SurfaceParts>();
  parts->options = options;
  parts->screen_radius = screen_radius;
  parts->hidden_from = infinity;
  parts->distance = options.projector.value_or(infinity);
  const Limit picture = picture_limit(options, screen_radius);
  options.lens ? build_lens(*parts, picture) : build_curve(*parts, picture);
  round_rim(*parts);
  parts_ = parts;
}

} // namespace domewarp
