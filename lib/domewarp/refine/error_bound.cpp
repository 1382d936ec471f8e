// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/error_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "domewarp/profile/half_angle.h"

namespace domewarp {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Room for the rounding of the factors below.
constexpr double slack = 1e-9;

Range operator+(const Range& a, const Range& b) { return {a.low + b.low, a.high + b.high}; }

Range operator*(const Range& a, const Range& b) {
  const double p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
  return {std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s))};
}

Range operator*(double f, const Range& a) { return {std::min(f * a.low, f * a.high), std::max(f * a.low, f * a.high)}; }

Range between(double a, double b) { return {std::min(a, b), std::max(a, b)}; }

/// The product with a range that is not negative.
Range scaled(const Range& factor, const Range& a) {
  return {std::min(factor.low * a.low, factor.high * a.low), std::max(factor.low * a.high, factor.high * a.high)};
}

/// Range of from + s (to - from), s in `share`, a subset of [0, 1].
Range blend(const Range& from, const Range& to, const Range& share) {
  const double low = to.low - from.low, high = to.high - from.high;
  return {from.low + std::min(low * share.low, low * share.high), from.high + std::max(high * share.low, high * share.high)};
}

double norm(double x, double y) { return std::sqrt(x * x + y * y); }

/// The heading along an edge: x = cos(chi) against the outward meridian, y = |sin(chi)|; and the angles passed.
struct Heading {
  Range x{-1, 1}, y{0, 1};
  double u_low = 0, u_high = 1;
};

/// With P = sin(theta) cos(chi) = -d cos(theta)/dpsi and N = sin(theta) sin(chi), which is constant, P^2 + N^2 =
/// sin^2(theta). P is monotone where cos(theta) keeps its sign, theta is extreme where P vanishes.
/// @param at_a,at_b P at the ends, @param n |N|
Heading heading(const Direction& a, const Direction& b, double at_a, double at_b, double n) {
  Heading h;
  h.u_low = std::min(a.u, b.u);
  h.u_high = std::max(a.u, b.u);
  const double n2 = n * n;
  Range p = between(at_a, at_b);
  const bool passes_right_angle = a.eye.z * b.eye.z < 0;
  if (passes_right_angle || (p.low < 0 && p.high > 0)) {
    const double top = std::sqrt(1 - n2);
    if (passes_right_angle) (a.eye.z < 0 ? p.high : p.low) = a.eye.z < 0 ? top : -top;
    if (p.low < 0 && p.high > 0) {
      const bool is_nearest = at_a < at_b; // theta falls, then rises
      (is_nearest ? h.u_low : h.u_high) = half_angle_index(n, is_nearest ? top : -top, 1);
    }
  }
  p.low -= slack;
  p.high += slack;
  const auto inverse_sine = [&](double q) { return 1 / std::sqrt(std::max(q * q + n2, 1e-300)); };
  const double low = inverse_sine(p.low), high = inverse_sine(p.high);
  h.x = {p.low * low - slack, p.high * high + slack};
  h.y = {std::max(0.0, n * std::min(low, high) - slack), p.low * p.high <= 0 ? 1 : std::min(1.0, n * std::max(low, high) + slack)};
  return h;
}

} // namespace

Direction direction_of(const Vec3& eye) {
  const double r2 = eye.x * eye.x + eye.y * eye.y, rho = std::sqrt(r2 + eye.z * eye.z);
  return {eye, rho, half_angle_index(std::sqrt(r2), -eye.z, rho)};
}

EdgeBend ErrorBound::edge(const Direction& a, const Direction& b, double wa, double wb) const {
  const Vec3 d = b.eye - a.eye, normal = glm::cross(a.eye, b.eye);
  const double dd = glm::dot(d, d), area2 = glm::dot(normal, normal), area = std::sqrt(area2);
  const double pa = glm::dot(a.eye, d), pb = glm::dot(b.eye, d);
  if (!(area > 1e-13 * a.rho * b.rho)) return {}; // one direction: nothing to interpolate
  const double inverse_a = 1 / a.rho, inverse_b = 1 / b.rho, inverse_area = 1 / area;

  const auto turned = [&](const Direction& p, double along, double inverse) { return (p.rho * d.z - p.eye.z * along * inverse) * inverse_area; };
  const Heading h = heading(a, b, turned(a, pa, inverse_a), turned(b, pb, inverse_b), std::min(1.0, std::abs(normal.z) * inverse_area));
  const RadialRange r = ranges_.over(h.u_low, h.u_high);

  // 1 / rho is greatest at the foot of the perpendicular from the eye, where that is on the edge.
  const bool has_foot = pa < 0 && pb > 0;
  const double near = has_foot ? std::sqrt(dd) * inverse_area : std::max(inverse_a, inverse_b), far = std::min(inverse_a, inverse_b);
  const Range kappa{area * far * far, area * near * near};
  // c and W / rho have one stationary point each, c where W / rho has its own or where `turn` changes sign.
  const double dw = wb - wa;
  const double ca = dw - wa * pa * inverse_a * inverse_a, cb = dw - wb * pb * inverse_b * inverse_b;
  Range c = between(ca, cb), speed = between(wa * inverse_a, wb * inverse_b);
  const double at_foot = wa * dd - dw * pa; // times dd, and so is `turn`
  const auto turn = [&](double p) { return at_foot * (p * p - area2) - 2 * dw * area2 * p; };
  const double turn_a = turn(pa), turn_b = turn(pb);
  const bool rises = c.low < 0 && c.high > 0;
  if (rises || (turn_a > 0) != (turn_b > 0)) {
    const double reach = norm(dw, at_foot * inverse_area);
    if (turn_a > 0 && turn_b < 0) c.high = std::max(c.high, 0.5 * (dw + reach));
    if (turn_a < 0 && turn_b > 0) c.low = std::min(c.low, 0.5 * (dw - reach));
    if (rises) speed.high = std::max(speed.high, reach / std::sqrt(dd));
  }
  const Range turning{area2 * (far * far * far) * speed.low, area2 * (near * near * near) * speed.high}; // kappa^2 W

  const Range change = scaled({2 * kappa.low, 2 * kappa.high}, c), y2{h.y.low * h.y.low, h.y.high * h.y.high};
  const Range radial = scaled(turning, blend(r.along, r.across, y2)) + change * (r.slope * h.x);
  const Range sideways = scaled(h.y, scaled({2 * turning.low, 2 * turning.high}, r.twist * h.x) + change * r.factor);
  EdgeBend bend;
  const double kink = r.slope_jump > 0 ? 2 * kappa.high * std::max(wa, wb) * r.slope_jump : 0;
  bend.second = (norm(magnitude(radial), magnitude(sideways)) + kink) * (1 + slack);
  if (!(bend.second < infinity)) bend.second = infinity;

  // Seen along the chord of the unit directions, |chord| >= cos(psi/2), the interpolated distance is 1 / |chord| times the
  // exact one, and the interpolated g differs from the exact one by at most a quarter of the range of its slope.
  const double apart = inverse_a * inverse_b, secant2 = 2 / (1 + glm::dot(a.eye, b.eye) * apart);
  bend.depth = std::sqrt(secant2) - 1;
  if (projection_ == Projection::perspective) {
    const Range along = r.weight_slope * h.x;
    const double rate = area * apart * (std::max(along.high, secant2 * along.high) - std::min(along.low, secant2 * along.low));
    bend.depth += (1 + bend.depth) * (0.25 * rate + r.weight_jump) / r.weight.low;
  }
  return bend;
}

Range ErrorBound::edge_span(const Direction& a, const Direction& b) const {
  const Vec3 d = b.eye - a.eye, normal = glm::cross(a.eye, b.eye);
  const double area = glm::length(normal);
  if (!(area > 1e-13 * a.rho * b.rho)) return between(a.u, b.u);
  const auto turned = [&](const Direction& p) { return (p.rho * d.z - p.eye.z * glm::dot(p.eye, d) / p.rho) / area; };
  const Heading h = heading(a, b, turned(a), turned(b), std::min(1.0, std::abs(normal.z) / area));
  return {h.u_low, h.u_high};
}

namespace {

/// The least that one radian moves the image.
double least_stretch(const RadialRange& r) {
  const auto least = [](const Range& a) { return a.low > 0 ? a.low : std::max(0.0, -a.high); };
  return std::min(least(r.slope), least(r.factor)) - r.slope_jump;
}

} // namespace

// The points of a slide are within the angle slide / stretch of where it begins, the stretch being that of the angles it passes.
double ErrorBound::slide_depth(const Range& span, double farthest, double distance, double slide) const {
  if (slide == 0) return 0;
  const double most = 2 * slide / least_stretch(ranges_.over(span.low, span.high));
  if (!(most > 0 && most < 1)) return infinity;
  const double margin = u_margin(most);
  const RadialRange r = ranges_.over(std::max(0.0, span.low - margin), std::min(1.0, span.high + margin));
  const double angle = slide / least_stretch(r);
  if (!(angle > 0 && angle <= most)) return infinity;
  const double cosine = std::min(1.0, distance / farthest), sine = std::sqrt(1 - cosine * cosine);
  const double beyond = cosine * std::cos(angle) - sine * std::sin(angle); // of the ray that the slide turns to at most
  if (!(beyond > 0)) return infinity;
  const double rho = cosine / beyond - 1;
  if (projection_ == Projection::orthographic) return rho;
  return (1 + rho) * (1 + (magnitude(r.weight_slope) * angle + r.weight_jump) / r.weight.low) - 1;
}

namespace {

/// The corners of a face as directions.
struct FaceDirections {
  std::array<Vec3, 3> unit;
  std::array<double, 3> inverse_rho;
  Vec3 cosine; ///< of the angles of its sides
};

FaceDirections face_directions(const std::array<const Direction*, 3>& corner) {
  FaceDirections face;
  for (int k = 0; k < 3; ++k) {
    face.inverse_rho[k] = 1 / corner[k]->rho;
    face.unit[k] = corner[k]->eye * face.inverse_rho[k];
  }
  for (int k = 0; k < 3; ++k) face.cosine[k] = glm::dot(face.unit[k], face.unit[(k + 1) % 3]);
  return face;
}

/// Azimuths over a face against its centroid's, theta, and what follows from them for the components of a vector.
struct FaceFrame {
  double cos_centre = 1, sin_centre = 0;
  Range cos_azimuth{-1, 1}, sin_azimuth{-1, 1}, cosine, sine;
  double u_low = 0, u_high = 1;
};

/// The theta range of a side beyond its ends.
void include_extreme(const Vec3& a, const Vec3& b, double cosine, FaceFrame& frame) {
  const double at_a = b.z - a.z * cosine, at_b = a.z - b.z * cosine; // of the same sign where z is extreme between them
  if (!(at_a * at_b > 0)) return;
  const Vec3 normal = glm::cross(a, b);
  const double side2 = normal.x * normal.x + normal.y * normal.y, side = std::sqrt(side2), area = std::sqrt(side2 + normal.z * normal.z);
  const double u = half_angle_index(std::abs(normal.z), at_a < 0 ? side : -side, area);
  (at_a < 0 ? frame.u_low : frame.u_high) = at_a < 0 ? std::min(frame.u_low, u) : std::max(frame.u_high, u);
}

double cosine_at(double u) { return (1 - 2 * u) / (1 - 2 * u + 2 * u * u); }
double sine_at(double u) { return 2 * u * (1 - u) / (1 - 2 * u + 2 * u * u); }

FaceFrame face_frame(const std::array<const Direction*, 3>& corner, const FaceDirections& face) {
  FaceFrame frame;
  frame.u_low = std::min({corner[0]->u, corner[1]->u, corner[2]->u});
  frame.u_high = std::max({corner[0]->u, corner[1]->u, corner[2]->u});
  const std::array<Vec3, 3>& unit = face.unit;
  Vec3 normal_z;
  for (int k = 0; k < 3; ++k) {
    const Vec3 &p = unit[k], &q = unit[(k + 1) % 3];
    include_extreme(p, q, face.cosine[k], frame);
    normal_z[k] = p.x * q.y - p.y * q.x;
  }
  const double least = std::min({normal_z.x, normal_z.y, normal_z.z}), most = std::max({normal_z.x, normal_z.y, normal_z.z});
  const Vec3 sum = unit[0] + unit[1] + unit[2];
  const double size2 = sum.x * sum.x + sum.y * sum.y;
  if (least > 0 || most < 0) { // an axis pierces the face; where it meets a side the side has told
    const double z = corner[0]->eye.z + corner[1]->eye.z + corner[2]->eye.z;
    (z < 0 ? frame.u_low : frame.u_high) = z < 0 ? 0 : 1;
  } else if (size2 > 0) {
    const double inverse_size = 1 / std::sqrt(size2);
    frame.cos_centre = sum.x * inverse_size;
    frame.sin_centre = sum.y * inverse_size;
    Range cosines{1, 1}, sines{1, -1};
    for (const Vec3& p : unit) {
      const double r2 = p.x * p.x + p.y * p.y, inverse_r = 1 / std::sqrt(r2);
      const double along = (p.x * frame.cos_centre + p.y * frame.sin_centre) * inverse_r;
      const double across = (p.y * frame.cos_centre - p.x * frame.sin_centre) * inverse_r;
      cosines.low = r2 > 0 ? std::min(cosines.low, along) : -1; // a corner on the axis has every azimuth
      sines = {std::min(sines.low, across), std::max(sines.high, across)};
    }
    if (cosines.low > 0) {
      frame.cos_azimuth = {cosines.low - slack, 1};
      frame.sin_azimuth = {sines.low - slack, sines.high + slack};
    }
  }
  frame.cosine = {cosine_at(frame.u_high) - slack, cosine_at(frame.u_low) + slack};
  frame.sine = between(sine_at(frame.u_low), sine_at(frame.u_high));
  if (frame.u_low < 0.5 && frame.u_high > 0.5) frame.sine.high = 1;
  frame.sine = {frame.sine.low - slack, frame.sine.high + slack};
  return frame;
}

Range square(const Range& a) {
  const double p = a.low * a.low, q = a.high * a.high;
  return {a.low <= 0 && a.high >= 0 ? 0 : std::min(p, q), std::max(p, q)};
}

/// Components of a vector v over a face: v . e_theta (forward is -z), v . e_phi, v . e_rho.
struct Components {
  Range along_meridian, across, away;
};

Components components_of(const Vec3& v, const FaceFrame& frame) {
  const double x = v.x * frame.cos_centre + v.y * frame.sin_centre, y = v.y * frame.cos_centre - v.x * frame.sin_centre;
  const Range outwards = x * frame.cos_azimuth + y * frame.sin_azimuth;
  return {frame.cosine * outwards + v.z * frame.sine, y * frame.cos_azimuth + (-x) * frame.sin_azimuth, frame.sine * outwards + (-v.z) * frame.cosine};
}

// With x = sum m_i d_i and g_i the weight factors of the corners, what is drawn over what is right is (sum m_i g_i / g) / |x|.
// 1 / |x| - 1 is convex in 1 - |x|^2 = sum m_i m_j |d_i - d_j|^2, so it is below its chord. And sum m_i g_i - g is the sum over
// i < j of m_i m_j times the difference of two means, over segments of the triangle, of g's derivative along d_i - d_j, which
// is g' (d_i - d_j) . e_theta / |x|: at most the range of that over the face.
FaceDepth depth_of(const FaceDirections& face, const FaceFrame& frame, const RadialRange& r, double inverse_sag, Projection projection) {
  FaceDepth depth;
  const double chord = (inverse_sag - 1) / (1 - 1 / (inverse_sag * inverse_sag));
  for (int k = 0; k < 3; ++k) depth.arch[k] = 0.25 * chord * (2 - 2 * face.cosine[k]);
  if (projection == Projection::perspective) {
    const double factor = inverse_sag / r.weight.low;
    for (int k = 0; k < 3; ++k) {
      const Range rate = Range{1, inverse_sag} * (r.weight_slope * components_of(face.unit[(k + 1) % 3] - face.unit[k], frame).along_meridian);
      depth.arch[k] += 0.25 * (rate.high - rate.low) * factor;
    }
    depth.jump = r.weight_jump * factor;
    depth.weights = r.weight.high / r.weight.low;
    if (!(depth.weights < infinity)) return {Vec3(0), infinity, 1};
  }
  depth.arch *= 1 + slack;
  return depth;
}

} // namespace

Range ErrorBound::face_span(const Direction& a, const Direction& b, const Direction& c) const {
  const std::array<const Direction*, 3> corner{&a, &b, &c};
  const FaceFrame frame = face_frame(corner, face_directions(corner));
  return {frame.u_low, frame.u_high};
}

FaceBend ErrorBound::face(const std::array<const Direction*, 3>& corner, const Vec3& weights, bool with_depth) const {
  const FaceDirections face = face_directions(corner);
  const FaceFrame frame = face_frame(corner, face);
  const RadialRange r = ranges_.over(frame.u_low, frame.u_high);
  // Seen along the triangle of unit directions d_i, |sum m_i d_i|^2 = 1 - sum m_i m_j |d_i - d_j|^2 >= 1 - max / 3.
  const double widest2 = 2 - 2 * std::min({face.cosine.x, face.cosine.y, face.cosine.z});
  const double inverse_sag = 1 / (std::sqrt(std::max(1e-6, 1 - widest2 / 3)) - slack);
  const std::array<double, 3>& inverse_rho = face.inverse_rho;
  const Vec3 at(weights.x * inverse_rho[0], weights.y * inverse_rho[1], weights.z * inverse_rho[2]);
  const Range inverse{std::min({inverse_rho[0], inverse_rho[1], inverse_rho[2]}), inverse_sag * std::max({inverse_rho[0], inverse_rho[1], inverse_rho[2]})};
  const Range speed{std::min({at.x, at.y, at.z}), inverse_sag * std::max({at.x, at.y, at.z})}; // W / rho
  const Range scale{speed.low * inverse.low, speed.high * inverse.high};
  FaceBend bend;
  if (with_depth) bend.depth = depth_of(face, frame, r, inverse_sag, projection_);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vec3 v = corner[next]->eye - corner[k]->eye;
    const double dw = weights[next] - weights[k];
    const auto [along_meridian, across, away] = components_of(v, frame);
    const Range turn = Range{dw, dw} + -1.0 * scaled(speed, away); // c of ErrorBound::edge
    const Range change = scaled({2 * inverse.low, 2 * inverse.high}, turn);
    const Range radial = scaled(scale, scaled(square(along_meridian), r.along) + scaled(square(across), r.across)) + change * (r.slope * along_meridian);
    const Range sideways = scaled({2 * scale.low, 2 * scale.high}, r.twist * (along_meridian * across)) + change * (r.factor * across);
    const double fastest = magnitude(along_meridian), kink = r.slope_jump > 0 ? 2 * fastest * fastest * scale.high * r.slope_jump : 0;
    const double bound = norm(magnitude(radial), magnitude(sideways)) + kink;
    bend.second[k] = bound < infinity ? bound * (1 + slack) : infinity;
  }
  return bend;
}

namespace {

/// peak_error where the weights are 1.
double peak_between(double at_a, double at_b, double arch) {
  const double rise = at_b - at_a + 4 * arch;
  return rise > 0 && rise < 8 * arch ? at_a + rise * rise / (16 * arch) : std::max(at_a, at_b);
}

} // namespace

double peak_face(const Vec3& at, const Vec3& arch) {
  if (!(arch.x < infinity && arch.y < infinity && arch.z < infinity)) return infinity;
  double peak = 0;
  for (int k = 0; k < 3; ++k) peak = std::max(peak, peak_between(at[k], at[(k + 1) % 3], arch[k]));
  // Stationary in s = l1, t = l2: [p q; q r] (s, t) = (x, y).
  const double p = 8 * arch.z, r = 8 * arch.y, q = -4 * (arch.x - arch.y - arch.z);
  const double x = at.x - at.z + 4 * arch.z, y = at.y - at.z + 4 * arch.y, determinant = p * r - q * q;
  if (!(determinant > 0)) return peak; // no maximum inside
  const double s = (x * r - y * q) / determinant, t = (y * p - x * q) / determinant, u = 1 - s - t;
  if (!(s > 0 && t > 0 && u > 0)) return peak;
  return std::max(peak, s * at.x + t * at.y + u * at.z + 4 * (s * t * arch.x + t * u * arch.y + u * s * arch.z));
}

// The linear weights over those that are right at the corners are a mean of 1 + at_i with the shares of weights.
double peak_depth(const Vec3& at, const FaceDepth& depth) {
  const double peak = peak_face(at * depth.weights, depth.arch) + depth.jump;
  return peak < infinity ? peak * (1 + peak) : infinity;
}

double peak_error(double at_a, double at_b, double second, double wa, double wb) {
  if (!(second < infinity)) return infinity;
  const double ends = std::max(at_a / wa, at_b / wb);
  const double half = 0.5 * second, rise = at_b - at_a + half, dw = wb - wa;
  // Stationary where (rise - 2 half t)(wa + dw t) = dw (at_a + rise t - half t^2).
  const double start = rise * wa - at_a * dw;
  const double root = half * half * wa * wa + half * dw * start;
  if (!(start > 0) || !(root >= 0)) return ends;
  const double t = start / (half * wa + std::sqrt(root));
  if (!(t < 1)) return ends;
  return std::max(ends, (at_a + rise * t - half * t * t) / (wa + dw * t));
}

} // namespace domewarp
