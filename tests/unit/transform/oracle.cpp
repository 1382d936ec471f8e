// SPDX-License-Identifier: Apache-2.0
#include "oracle.h"

#include <cmath>
#include <stdexcept>

#include "surfaces.h"

namespace domewarp {

namespace {

struct Direction {
  Real s, c; // sine and cosine of theta times |p|
};

Direction direction_of(const Vec3& p) { return {sqrt(Real(p.x) * Real(p.x) + Real(p.y) * Real(p.y)), Real(-p.z)}; }

Real slope(const ReferenceCurve& curve, const Real& r) {
  const Real step("1e-25");
  return (curve.value(r + step) - curve.value(r - step)) / (step + step);
}

Real fold_function(const ReferenceCurve& curve, const Real& r) { return curve.value(r) - r * slope(curve, r); }

// Where the sign of f changes between lo and hi.
template <typename Function>
Real bisect(const Function& f, Real lo, Real hi) {
  const bool negative = f(lo) < Real(0);
  if ((f(hi) < Real(0)) == negative) throw std::logic_error("no change of sign between " + std::to_string(double(lo)) + " and " + std::to_string(double(hi)));
  for (int i = 0; i < 190; ++i) {
    const Real middle = (lo + hi) / Real(2);
    ((f(middle) < Real(0)) == negative ? lo : hi) = middle;
  }
  return lo;
}

class CurveOracle : public Oracle {
public:
  CurveOracle(const ReferenceCurve& curve, const Surface& surface)
      : curve_(curve), distance_(surface.options().projector.value_or(0)) {
    ends_.push_back({Real(0), curve.value(Real(0))});
    const std::size_t count = surface.branches().size();
    for (std::size_t i = 0; i + 1 < count; ++i) {
      const Branch& branch = surface.branches()[i];
      add_fold(surface.meridian(branch.orientation > 0 ? branch.radius_high : branch.radius_low)->x);
    }
    add_end(surface);
    const Real last = ends_[count].r;
    tangent_ = {Real(1), slope(curve, last)};
    if (tangent_.z.is_nan()) tangent_ = {Real(0), Real(-1)}; // no curve beyond: all of these drop vertically
    // Where the tangent passes the projector.
    const Real down = -Real(distance_);
    if (distance_ > 0) behind_ = {last + tangent_.r * (down - ends_[count].z) / tangent_.z, down};
  }

  Answer answer(const Vec3& p) const override {
    const Direction way = direction_of(p);
    const std::size_t count = ends_.size() - 1;
    bool is_close = touches(tangent_, way) || touches(behind_, way);
    for (const End& end : ends_) is_close = is_close || (!is_double(end) && touches(end, way));
    for (std::size_t i = 0; i < count; ++i)
      if (contains(i, way)) return {PointState::visible, i, is_close};
    return {is_extended(way) ? PointState::extended : PointState::blind, 0, is_close};
  }

  bool confirms(std::size_t branch, const Vec3& p, double radius, double relative, double absolute) const override {
    const Direction way = direction_of(p);
    const Real less = Real(radius) * (Real(1) - Real(relative)) - Real(absolute);
    const Real more = Real(radius) * (Real(1) + Real(relative)) + Real(absolute);
    const bool starts_in = !(way_of(way, branch, uncompensate(way, less)) < Real(0));
    return starts_in && !(Real(0) < way_of(way, branch, uncompensate(way, more)));
  }

private:
  struct End {
    Real r, z;
  };

  // The zero of h + offset near a place.
  void add_fold(double near, double offset = 0) {
    const auto function = [&](const Real& x) { return fold_function(curve_, x) + Real(offset); };
    const Real r = bisect(function, Real(near * (1 - 1e-7)), Real(near * (1 + 1e-7)));
    ends_.push_back({r, curve_.value(r)});
  }

  void add_end(const Surface& surface) {
    Real r(surface.r_max());
    if (surface.r_max_limit() == RadiusLimit::domain) {
      r = Real(curve_.end);
      if (distance_ > 0 || surface.r_max() == curve_.end) return ends_.push_back({r, curve_.value(r)});
      throw std::logic_error("the oracle knows another domain");
    }
    if (surface.r_max_limit() == RadiusLimit::projector) return add_fold(surface.rim().point.x, distance_);
    if (distance_ > 0) {
      const double near = surface.meridian(surface.r_max())->x;
      const auto excess = [&](const Real& x) {
        return x * Real(distance_) - Real(surface.r_max()) * (curve_.value(x) + Real(distance_));
      };
      const Real end(curve_.end);
      const bool stops = slope(curve_, end).is_nan() && !(Real(0) < excess(end)); // before the picture does
      r = stops ? end : bisect(excess, Real(near * (1 - 1e-7)), Real(near * (1 + 1e-7)));
    }
    ends_.push_back({r, curve_.value(r)});
  }

  // Positive where the direction is farther from the forward axis than the end.
  static Real beyond(const End& end, const Direction& way) { return way.s * end.z - way.c * end.r; }

  static bool is_double(const End& end) {
    const auto rounds = [](const Real& x) { return x.compare(static_cast<double>(x)) != 0; };
    return !rounds(end.r) && !rounds(end.z);
  }

  static bool touches(const End& end, const Direction& way) {
    return abs(beyond(end, way)) < Real("1e-30") * (way.s + abs(way.c)) * (abs(end.r) + abs(end.z));
  }

  bool rises(std::size_t i) const { return Real(0) < beyond(ends_[i], {ends_[i + 1].r, ends_[i + 1].z}); }

  bool contains(std::size_t i, const Direction& way) const {
    const Real sign(rises(i) ? 1 : -1);
    const Real low = sign * beyond(ends_[i], way), high = sign * beyond(ends_[i + 1], way);
    return (i == 0 || !(low < Real(0))) && !(Real(0) < high);
  }

  bool is_extended(const Direction& way) const {
    const End& rim = ends_.back();
    const Real moment = rim.z * tangent_.r - rim.r * tangent_.z, slant = way.c * tangent_.r - way.s * tangent_.z;
    if (!(Real(0) < moment * slant)) return false;
    const Real scale = moment / slant;
    if (way.s * scale < rim.r * (Real(1) - Real("1e-40"))) return false;
    return distance_ == 0 || Real(0) < way.c * scale + Real(distance_);
  }

  // The point of the ray that the projector shows at an image radius.
  Real uncompensate(const Direction& way, const Real& radius) const {
    if (distance_ == 0) return radius;
    const Real share = Real(distance_) - radius * way.c / way.s;
    return Real(0) < share ? radius * Real(distance_) / share : Real(1e300); // no point of the ray appears so far out
  }

  // Positive while r is nearer to the axis than where the direction meets the branch, kept within its ends.
  Real way_of(const Direction& way, std::size_t branch, Real r) const {
    if (r < ends_[branch].r) return Real(1);
    if (ends_[branch + 1].r < r) return Real(-1);
    const Real value = curve_.value(r) * way.s - r * way.c;
    return rises(branch) ? value : -value;
  }

  ReferenceCurve curve_;
  double distance_;
  std::vector<End> ends_;
  End tangent_{Real(0), Real(0)}, behind_{Real(0), Real(0)};
};

class LensOracle : public Oracle {
public:
  LensOracle(Lens lens, double fov_deg, double screen)
      : lens_(lens), half_(Real(fov_deg) * pi() / Real(360)), scale_(Real(1) / radius(half_)), screen_(screen),
        edge_is_right_(fov_deg == 180 && screen >= 1) {
    const Real end = edge(), step("1e-25");
    const auto at = [&](const Real& theta) {
      const Real r = scale_ * radius(theta);
      return std::pair(r, r * cos(theta) / sin(theta));
    };
    const auto [r, z] = at(end);
    const auto [r0, z0] = at(end - step);
    const auto [r1, z1] = at(end + step);
    rim_r_ = r;
    rim_z_ = z;
    tangent_r_ = (r1 - r0) / (step + step);
    tangent_z_ = (z1 - z0) / (step + step);
  }

  Answer answer(const Vec3& p) const override {
    const Direction way = direction_of(p);
    const Real theta = atan2(way.s, way.c), gap = edge() - theta;
    const bool is_inside = edge_is_right_ ? way.c.compare(0) >= 0 : !(gap < Real(0));
    if (is_inside) return {PointState::visible, 0, !edge_is_right_ && gap < Real("1e-30")};
    const Real moment = rim_z_ * tangent_r_ - rim_r_ * tangent_z_, slant = way.c * tangent_r_ - way.s * tangent_z_;
    const bool is_close = -gap < Real("1e-30") && !edge_is_right_;
    const bool is_parallel = abs(slant) < Real("1e-30") * (way.s + abs(way.c)); // tangent_ is a difference
    return {Real(0) < moment * slant ? PointState::extended : PointState::blind, 0, is_close || is_parallel};
  }

  bool confirms(std::size_t, const Vec3& p, double value, double relative, double absolute) const override {
    const Direction way = direction_of(p);
    const Real expected = scale_ * radius(atan2(way.s, way.c));
    return !(Real(value) * Real(relative) + Real(absolute) < abs(Real(value) - expected));
  }

private:
  Real radius(const Real& theta) const {
    switch (lens_) {
    case Lens::equidistant: return theta;
    case Lens::equisolid: return sin(theta / Real(2));
    case Lens::stereographic: return tan(theta / Real(2));
    default: return sin(theta);
    }
  }

  Real edge() const {
    if (screen_ >= 1) return half_;
    const Real r = Real(screen_) / scale_;
    switch (lens_) {
    case Lens::equidistant: return r;
    case Lens::equisolid: return Real(2) * asin(r);
    case Lens::stereographic: return Real(2) * atan(r);
    default: return asin(r);
    }
  }

  Lens lens_;
  Real half_, scale_;
  double screen_;
  bool edge_is_right_;
  Real rim_r_, rim_z_, tangent_r_, tangent_z_;
};

} // namespace

Case curve_case(const ReferenceCurve& curve, double screen, double projector) {
  Surface surface = curve_surface(curve.text, projector > 0 ? std::optional(projector) : std::nullopt, screen);
  auto oracle = std::make_unique<CurveOracle>(curve, surface);
  return {describe(surface), std::move(surface), std::move(oracle)};
}

Case lens_case(Lens lens, double fov_deg, double screen) {
  SurfaceOptions options;
  options.lens = lens;
  options.fov_deg = fov_deg;
  Surface surface(options, screen);
  return {describe(surface), std::move(surface), std::make_unique<LensOracle>(lens, fov_deg, screen)};
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const ReferenceCurve& curve : reference_curves())
    for (const double screen : {1.0, corner_radius})
      for (const double projector : {0.0, 1.5}) cases.push_back(curve_case(curve, screen, projector));
  for (const double screen : {0.8, corner_radius}) {
    for (const double fov : {60.0, 180.0, 300.0})
      for (const Lens lens : {Lens::equidistant, Lens::equisolid, Lens::stereographic})
        cases.push_back(lens_case(lens, fov, screen));
    cases.push_back(lens_case(Lens::orthographic, 180, screen));
  }
  return cases;
}

std::vector<double> critical_angles(const Surface& surface) {
  std::vector<double> angles{surface.blind().theta_low, surface.blind().theta_high};
  for (const Branch& branch : surface.branches()) {
    angles.push_back(branch.theta_low);
    angles.push_back(branch.theta_high);
  }
  return angles;
}

} // namespace domewarp
