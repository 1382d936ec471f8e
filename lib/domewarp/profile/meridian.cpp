// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "domewarp/profile/analysis.h"
#include "domewarp/profile/half_angle.h"
#include "domewarp/profile/root.h"
#include "domewarp/profile/surface_parts.h"

namespace domewarp {

namespace {

constexpr double largest = std::numeric_limits<double>::max();

double finite(double x) { return std::isnan(x) ? 0 : std::clamp(x, -largest, largest); }

struct Slopes {
  double theta, d, d2;
};

// R' = q / h, R'' = q^2 r f'' / h^3 + 2 q (r + f f') / h^2.
Slopes slopes_at(const Jet<double>& f, double r) {
  const double q = r * r + f.v * f.v, h = f.v - jet_rules::times(r, f.d);
  return {std::atan2(r, f.v), q / h, (q * jet_rules::times(r, f.dd) / h + 2 * (r + f.v * f.d)) * (q / h / h)};
}

// At a vertical tangent f' is infinite while R(theta) is smooth: take the slopes a little inside and go on from there.
bool is_steep(const Jet<double>& f) { return !(std::abs(f.d) < 1e6 && std::isfinite(f.dd)); }

} // namespace

double compensate(double distance, double r, double z) {
  return std::isinf(distance) ? r : r * (distance / (z + distance));
}

RadialJet compensate(double distance, const MeridianJet& m) {
  if (std::isinf(distance)) return m.r;
  const double scale = 1 / (m.z.r + distance), r = m.r.r * distance * scale;
  const double dr = (m.r.dr * distance - r * m.z.dr) * scale;
  return {r, finite(dr), finite((m.r.d2r * distance - 2 * dr * m.z.dr - r * m.z.d2r) * scale)};
}

MeridianJet curve_meridian(const Curve& curve, const Span& span, double theta, const Vec2& point) {
  const double r = point.x;
  double at = r;
  Jet<double> f = differentiate(curve, r);
  if (is_steep(f)) {
    const double inwards = r - span.r_low > span.r_high - r ? -1 : 1;
    at = r + inwards * std::min(1e-12 * span.r_high, 0.5 * (span.r_high - span.r_low));
    f = differentiate(curve, at);
  }
  const Slopes slopes = slopes_at(f, at);
  double dr = slopes.d;
  if (at != r) dr += slopes.d2 * (theta - slopes.theta);
  // A fold's slope is infinite with the branch's sign, whichever side rounding put it on.
  if (std::isinf(dr)) dr = span.orientation * largest;
  MeridianJet m{{r, finite(dr), finite(slopes.d2)}, {}};
  m.z = {point.y, finite(f.d * m.r.dr), finite(f.dd * m.r.dr * m.r.dr + f.d * m.r.d2r)};
  if (std::abs(f.d) > 1) { // z = R cot(theta) then loses less than the chain rule
    const double s = std::sin(theta), c = std::cos(theta);
    m.z.dr = finite((m.r.dr * c - r / s) / s);
    m.z.d2r = finite((m.r.d2r * c - 2 * (m.r.dr - r * c / s) / s) / s);
  }
  return m;
}

MeridianJet lens_meridian(const LensForm& lens, double theta) { return {radial(lens, theta), depth(lens, theta)}; }

namespace {

// @param part of the way from the index at r_low to that at r_high
double guess_radius(const Span& span, double part) {
  if (span.guesses.empty()) return span.r_low + (span.r_high - span.r_low) * part;
  // The cubic through the four nearest.
  const double place = part * Span::guess_cells;
  const int first = static_cast<int>(std::clamp(place, 1.0, Span::guess_cells - 2.0)) - 1;
  const double* const r = &span.guesses[static_cast<std::size_t>(first)];
  const double x = place - first, a = x * (x - 1) / 2, b = (x - 2) * (x - 3) / 2;
  return b * (r[1] * x - r[0] * (x - 1) / 3) + a * (r[3] * (x - 2) / 3 - r[2] * (x - 3));
}

} // namespace

void tabulate_guesses(const Curve& curve, Span& span) {
  std::vector<double> guesses{span.r_low};
  for (int i = 1; i < Span::guess_cells; ++i) {
    const double n = span.index_at_low + (span.index_at_high - span.index_at_low) * i / Span::guess_cells;
    const double o = 1 - n, square = n * n + o * o;
    guesses.push_back(curve_point(curve, span, 2 * n * o / square, (o - n) * (o + n) / square).x);
  }
  guesses.push_back(span.r_high);
  span.guesses = std::move(guesses);
}

Vec2 curve_point(const Curve& curve, const Span& span, double s, double c) {
  const double sign = span.orientation;
  if (!((span.z_low * s - span.r_low * c) * sign > 0)) return {span.r_low, span.z_low};
  if (!((span.z_high * s - span.r_high * c) * sign < 0)) return {span.r_high, span.z_high};
  const auto function = [&](double r) {
    const Jet<double> f = differentiate(curve, r);
    return ValueAndSlope<double>{f.v * s - r * c, f.d * s - c};
  };
  const double part = (half_angle_index(s, c, 1) - span.index_at_low) / (span.index_at_high - span.index_at_low);
  const double r = find_root(function, span.r_low, span.r_high, guess_radius(span, part), sign);
  // Near a vertical tangent f(r) would magnify the rounding of r; the ray knows z as well.
  return {r, s > 0 ? r * c / s : span.z_low};
}

} // namespace domewarp
