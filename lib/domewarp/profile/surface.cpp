// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "domewarp/profile/root.h"
#include "domewarp/profile/surface_parts.h"

namespace domewarp {

namespace {

constexpr double pi = std::numbers::pi;

Vec2 unit(double r, double z) {
  const double length = std::hypot(r, z);
  return {r / length, z / length};
}

} // namespace

const char* to_string(RadiusLimit limit) {
  switch (limit) {
  case RadiusLimit::user: return "user";
  case RadiusLimit::screen: return "screen";
  case RadiusLimit::domain: return "domain";
  case RadiusLimit::fold: return "fold";
  case RadiusLimit::projector: return "projector";
  default: return "lens";
  }
}

const char* to_string(KinkKind kind) {
  switch (kind) {
  case KinkKind::corner: return "corner";
  case KinkKind::vertical_tangent: return "vertical tangent";
  default: return "joint";
  }
}

const SurfaceOptions& Surface::options() const { return parts_->options; }
double Surface::r_max() const { return parts_->r_max; }
RadiusLimit Surface::r_max_limit() const { return parts_->limit; }
const std::vector<Branch>& Surface::branches() const { return parts_->branches; }
const std::vector<double>& Surface::joints(std::size_t branch) const { return parts_->joints[branch]; }

double Surface::radius(std::size_t branch, double s, double c) const {
  const Branch& range = parts_->branches[branch];
  if (!parts_->lens) {
    const Vec2 point = curve_point(parts_->curve, parts_->spans[branch], s, c);
    return compensate(parts_->distance, point.x, point.y);
  }
  if (s * std::cos(range.theta_high) >= c * std::sin(range.theta_high)) return range.radius_high;
  const double r = domewarp::radius(*parts_->lens, s, c);
  const double z = std::isinf(parts_->distance) ? 0 : depth(*parts_->lens, std::atan2(s, c)).r;
  return compensate(parts_->distance, r, z);
}

RadialJet Surface::radial(std::size_t branch, double theta) const {
  const Branch& range = parts_->branches[branch];
  const Span& span = parts_->spans[branch];
  theta = std::clamp(theta, range.theta_low, range.theta_high);
  if (parts_->lens) return compensate(parts_->distance, lens_meridian(*parts_->lens, theta));
  const Vec2 point = theta == span.theta_at_low    ? Vec2(span.r_low, span.z_low)
                     : theta == span.theta_at_high ? Vec2(span.r_high, span.z_high)
                                                   : curve_point(parts_->curve, span, std::sin(theta), std::cos(theta));
  return compensate(parts_->distance, curve_meridian(parts_->curve, span, theta, point));
}

namespace {

// Whether rounding moves the root r of F(r) = f(r) s - r c, and its compensated radius, by less than the direct method
// promises.
bool is_certain(const SurfaceParts& parts, const Vec2& point, double s, double c) {
  constexpr double promise = 4e-14, rounding = 4.5e-16;
  const Rounded f = evaluate_rounded(parts.curve, point.x);
  const double slope = std::abs(differentiate(parts.curve, point.x).d * s - c);
  const double noise = f.e * s + rounding * (std::abs(f.v) * s + point.x * std::abs(c));
  const double z = std::abs(point.y), d = parts.distance;
  const bool compensates = std::isinf(d) || rounding * (z + d) <= 0.1 * promise * (point.y + d);
  return compensates && noise <= promise * point.x * slope;
}

} // namespace

namespace {

// A direction by its sine and cosine, and where it meets the branch.
struct Meeting {
  double s, c;
  Vec2 point{0, 0};
};

Meeting meet_curve(const SurfaceParts& parts, std::size_t branch, const Vec3& p) {
  const double side = std::hypot(p.x, p.y), length = std::hypot(side, p.z);
  Meeting meeting{side / length, -p.z / length};
  if (!parts.lens) meeting.point = curve_point(parts.curve, parts.spans[branch], meeting.s, meeting.c);
  return meeting;
}

double settled_radius(const SurfaceParts& parts, std::size_t branch, const Vec3& p, const Meeting& meeting) {
  const auto [s, c, point] = meeting;
  if (is_certain(parts, point, s, c)) return compensate(parts.distance, point.x, point.y);
  const Span& span = parts.spans[branch];
  const QuadPoint exact = meet(parts.curve, span.low, span.high, span.orientation, about_axis(p), point.x);
  if (std::isinf(parts.distance)) return static_cast<double>(exact.r);
  return static_cast<double>(exact.r * parts.distance / (exact.z + parts.distance));
}

} // namespace

double Surface::radius(std::size_t branch, const Vec3& p) const {
  const Meeting meeting = meet_curve(*parts_, branch, p);
  return parts_->lens ? radius(branch, meeting.s, meeting.c) : settled_radius(*parts_, branch, p, meeting);
}

RadialJet Surface::radial(std::size_t branch, const Vec3& p) const {
  const Branch& range = parts_->branches[branch];
  const Meeting meeting = meet_curve(*parts_, branch, p);
  const double theta = std::clamp(std::atan2(meeting.s, meeting.c), range.theta_low, range.theta_high);
  const MeridianJet meridian = parts_->lens ? lens_meridian(*parts_->lens, theta)
                                            : curve_meridian(parts_->curve, parts_->spans[branch], theta, meeting.point);
  RadialJet jet = compensate(parts_->distance, meridian);
  jet.r = parts_->lens ? radius(branch, meeting.s, meeting.c) : settled_radius(*parts_, branch, p, meeting);
  return jet;
}

bool Surface::shows(std::size_t branch, const Vec3& p) const {
  const QuadPoint direction = about_axis(p);
  const Span& span = parts_->spans[branch];
  const bool after_low = span.r_low == 0 || side_of(span.low, direction) * span.orientation >= 0;
  return after_low && side_of(span.high, direction) * span.orientation <= 0;
}

namespace {

std::optional<double> within_reach(const SurfaceParts& parts, double image) {
  return std::isfinite(image) ? std::optional(std::max(image, parts.r_max)) : std::nullopt;
}

std::optional<double> exact_extended_radius(const SurfaceParts& parts, const Vec3& p) {
  const auto [s, c] = about_axis(p);
  const QuadPoint rim = parts.spans.back().high, tangent = parts.rim_tangent;
  const Quad moment = rim.z * tangent.r - rim.r * tangent.z, slant = c * tangent.r - s * tangent.z;
  if (!(moment * slant > 0)) return std::nullopt;
  const Quad r = s * (moment / slant), depth = c * (moment / slant) + parts.distance;
  if (!(r >= rim.r * (Quad(1) - 1e-25)) || !(depth > 0)) return std::nullopt;
  return within_reach(parts, static_cast<double>(std::isinf(parts.distance) ? r : r * parts.distance / depth));
}

// Whether a sum of two terms has lost so little to cancellation that its sign is sure and it is within 1e-14 if they are to rounding.
bool is_sure(double a, double b) { return std::abs(a + b) > 0.05 * (std::abs(a) + std::abs(b)); }

} // namespace

std::optional<double> Surface::extended_radius(const Vec3& p) const {
  const SurfaceParts& parts = *parts_;
  const Vec2 tangent = parts.rim_slope;
  if (parts.rim_moment == 0) return std::nullopt;
  const double s = std::sqrt(p.x * p.x + p.y * p.y), c = -p.z, size = s + std::abs(c);
  const double slant = c * tangent.x - s * tangent.y;
  const bool is_moderate = size > 1e-100 && size < 1e100; // squares neither overflow nor vanish
  if (!is_moderate || !is_sure(c * tangent.x, -s * tangent.y)) return exact_extended_radius(parts, p);
  if (parts.rim_moment * slant < 0) return std::nullopt;
  const double along = parts.rim_moment / slant, r = s * along, rim = parts.rim.point.x;
  constexpr double margin = 1e-12;
  if (r < rim * (1 - margin)) return std::nullopt;
  // A vertical tangent keeps to the rim's radius.
  if (r < rim * (1 + margin) && tangent.x != 0) return exact_extended_radius(parts, p);
  if (std::isinf(parts.distance)) return within_reach(parts, r);
  if (!is_sure(c * along, parts.distance)) return exact_extended_radius(parts, p);
  const double depth = c * along + parts.distance;
  return depth > 0 ? within_reach(parts, r * parts.distance / depth) : std::nullopt;
}

namespace {

// How far the tangent extension reaches: the angle of the tangent, or less where it passes behind the projector.
double extension_end(const SurfaceParts& parts, bool rises) {
  const auto& [point, tangent] = parts.rim;
  const double end = std::atan2(tangent.x, tangent.y);
  if (std::isinf(parts.distance) || tangent.y >= 0) return end;
  const double r = point.x + (-parts.distance - point.y) * tangent.x / tangent.y;
  const double behind = std::atan2(r, -parts.distance);
  return rises ? std::min(end, behind) : std::max(end, behind);
}

} // namespace

// theta is continuous along the curve, so its branches leave no gap between them: what is blind lies on one side.
BlindCone Surface::blind() const {
  double low = pi, high = 0;
  for (const Branch& branch : parts_->branches) {
    low = std::min(low, branch.theta_low);
    high = std::max(high, branch.theta_high);
  }
  const bool ends = parts_->rim.tangent == Vec2(0, 0), rises = parts_->branches.back().orientation > 0;
  if (low == 0) {
    if (!ends && rises) high = std::max(high, extension_end(*parts_, rises));
    return {std::min(high, pi), pi};
  }
  if (!ends && !rises) low = std::min(low, extension_end(*parts_, rises));
  return {0, low};
}

SurfaceRim Surface::rim() const { return parts_->rim; }
const std::vector<Kink>& Surface::kinks() const { return parts_->kinks; }
double Surface::hidden_from() const { return parts_->hidden_from; }
double Surface::screen_radius() const { return parts_->screen_radius; }

std::optional<Vec2> Surface::meridian(double image_radius) const {
  if (!(image_radius >= 0 && image_radius <= parts_->r_max)) return std::nullopt;
  const Span& first = parts_->spans.front();
  const Span& last = parts_->spans.back();
  const double d = parts_->distance;
  if (parts_->lens) {
    const Vec2 way = *direction(image_radius);
    const double theta = std::atan2(way.x, way.y);
    const MeridianJet m = lens_meridian(*parts_->lens, theta);
    return Vec2{m.r.r, m.z.r};
  }
  if (image_radius == 0) return Vec2{0, first.z_low};
  if (image_radius == parts_->r_max) return Vec2{last.r_high, last.z_high};
  if (std::isinf(d)) return Vec2{image_radius, evaluate(parts_->curve, image_radius)};
  // Eq. 24 in homogeneous form: the ray from the projector through the image point meets the curve.
  const auto function = [&](double r) {
    const Jet<double> f = differentiate(parts_->curve, r);
    return ValueAndSlope<double>{r * d - image_radius * (f.v + d), d - image_radius * f.d};
  };
  const double guess = last.r_high * image_radius / parts_->r_max;
  const double r = find_root(function, first.r_low, last.r_high, guess, -1);
  const Jet<double> f = differentiate(parts_->curve, r);
  // Near a vertical tangent f(r) magnifies the rounding of r; the projector's ray knows z as well.
  const bool steep = !(std::abs(f.d) * r < d);
  return Vec2{r, steep ? d * ((r - image_radius) / image_radius) : f.v};
}

std::optional<Vec2> Surface::direction(double image_radius) const {
  if (!(image_radius >= 0 && image_radius <= parts_->r_max)) return std::nullopt;
  if (!parts_->lens) {
    const Vec2 point = *meridian(image_radius);
    return unit(point.x, point.y);
  }
  double theta = 0;
  const Branch& range = parts_->branches.front();
  if (image_radius == parts_->r_max) {
    theta = range.theta_high;
  } else if (std::isinf(parts_->distance)) {
    theta = angle(*parts_->lens, image_radius);
  } else if (image_radius > 0) {
    const auto function = [&](double t) {
      const RadialJet jet = compensate(parts_->distance, lens_meridian(*parts_->lens, t));
      return ValueAndSlope<double>{jet.r - image_radius, jet.dr};
    };
    theta = find_root(function, 0.0, range.theta_high, range.theta_high * image_radius / parts_->r_max, -1);
  }
  return Vec2{std::sin(theta), theta == 0.5 * pi ? 0 : std::cos(theta)};
}

std::size_t Surface::branch_at(double image_radius) const {
  for (std::size_t i = 0; i < parts_->branches.size(); ++i) {
    const auto [least, most] = std::minmax(parts_->branches[i].radius_low, parts_->branches[i].radius_high);
    if (image_radius >= least && image_radius <= most) return i;
  }
  return 0;
}

} // namespace domewarp
