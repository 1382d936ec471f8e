// SPDX-License-Identifier: Apache-2.0
#include "oracle.h"

#include <cmath>
#include <stdexcept>

#include "surfaces.h"

namespace domewarp {

namespace {

// T is Real or Rough: what error bounds leave open in the latter is asked of the former.
template <typename T>
struct Direction {
  T s, c; // sine and cosine of theta times |p|
};

template <typename T>
Direction<T> direction_of(const Vec3& p) {
  return {sqrt(T(p.x) * T(p.x) + T(p.y) * T(p.y)), T(-p.z)};
}

template <typename T>
struct End {
  T r, z;
};

End<Rough> rough(const End<Real>& end) { return {Rough(end.r), Rough(end.z)}; }

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

// Positive where the direction is farther from the forward axis than the end.
template <typename T>
T beyond(const End<T>& end, const Direction<T>& way) {
  return way.s * end.z - way.c * end.r;
}

template <typename T>
bool touches(const End<T>& end, const Direction<T>& way) {
  return abs(beyond(end, way)) < T("1e-30") * (way.s + abs(way.c)) * (abs(end.r) + abs(end.z));
}

template <typename T>
struct CurveJudge {
  ReferenceCurve curve;
  double distance = 0; // of the projector; 0 without one
  std::vector<End<T>> ends{};
  std::vector<bool> is_rounded{}; // ends that are no doubles
  std::vector<bool> rises{};      // between an end and the next
  End<T> tangent{T(0), T(0)}, behind{T(0), T(0)};

  Oracle::Answer answer(const Direction<T>& way) const {
    const std::size_t count = ends.size() - 1;
    bool is_close = touches(tangent, way) || (distance > 0 && touches(behind, way));
    for (std::size_t i = 1; i <= count; ++i) is_close = is_close || (is_rounded[i] && touches(ends[i], way));
    for (std::size_t i = 0; i < count; ++i)
      if (contains(i, way)) return {PointState::visible, i, is_close};
    return {is_extended(way) ? PointState::extended : PointState::blind, 0, is_close};
  }

  bool confirms(std::size_t branch, const Direction<T>& way, double radius, double relative, double absolute) const {
    const T less = T(radius) * (T(1) - T(relative)) - T(absolute), more = T(radius) * (T(1) + T(relative)) + T(absolute);
    const bool starts_in = !(way_of(way, branch, uncompensate(way, less)) < T(0));
    return starts_in && !(T(0) < way_of(way, branch, uncompensate(way, more)));
  }

  bool contains(std::size_t i, const Direction<T>& way) const {
    const T sign(rises[i] ? 1 : -1);
    return (i == 0 || !(sign * beyond(ends[i], way) < T(0))) && !(T(0) < sign * beyond(ends[i + 1], way));
  }

  bool is_extended(const Direction<T>& way) const {
    const End<T>& rim = ends.back();
    const T moment = rim.z * tangent.r - rim.r * tangent.z, slant = way.c * tangent.r - way.s * tangent.z;
    if (!(T(0) < moment * slant)) return false;
    const T scale = moment / slant;
    if (way.s * scale < rim.r * (T(1) - T("1e-40"))) return false;
    return distance == 0 || T(0) < way.c * scale + T(distance);
  }

  // The point of the ray that the projector shows at an image radius.
  T uncompensate(const Direction<T>& way, const T& radius) const {
    if (distance == 0) return radius;
    const T share = T(distance) - radius * way.c / way.s;
    return T(0) < share ? radius * T(distance) / share : T(1e300); // no point of the ray appears so far out
  }

  // Positive while r is nearer to the axis than where the direction meets the branch, kept within its ends.
  T way_of(const Direction<T>& way, std::size_t branch, const T& r) const {
    if (r < ends[branch].r) return T(1);
    if (ends[branch + 1].r < r) return T(-1);
    const T value = curve.at(r) * way.s - r * way.c;
    return rises[branch] ? value : -value;
  }
};

CurveJudge<Rough> rough(const CurveJudge<Real>& judge) {
  CurveJudge<Rough> quick{judge.curve, judge.distance, {}, judge.is_rounded, judge.rises, rough(judge.tangent), rough(judge.behind)};
  for (const End<Real>& end : judge.ends) quick.ends.push_back(rough(end));
  return quick;
}

// Finds the ends of a surface's branches again, in sixty digits.
class JudgeBuilder {
public:
  JudgeBuilder(const ReferenceCurve& curve, const Surface& surface)
      : curve_(curve), surface_(surface), judge_{curve, surface.options().projector.value_or(0)} {}

  CurveJudge<Real> build() {
    judge_.ends.push_back({Real(0), curve_.value(Real(0))});
    const std::size_t count = surface_.branches().size();
    for (std::size_t i = 0; i + 1 < count; ++i) {
      const Branch& branch = surface_.branches()[i];
      add_fold(surface_.meridian(branch.orientation > 0 ? branch.radius_high : branch.radius_low)->x);
    }
    add_end();
    for (std::size_t i = 0; i < judge_.ends.size(); ++i) {
      const End<Real>& end = judge_.ends[i];
      judge_.is_rounded.push_back(rounds(end.r) || rounds(end.z));
      if (i > 0) judge_.rises.push_back(Real(0) < beyond(judge_.ends[i - 1], {end.r, end.z}));
    }
    const Real last = judge_.ends[count].r;
    judge_.tangent = {Real(1), slope(curve_, last)};
    if (judge_.tangent.z.is_nan()) judge_.tangent = {Real(0), Real(-1)}; // no curve beyond: all of these drop vertically
    // Where the tangent passes the projector.
    const Real down = -Real(judge_.distance);
    if (judge_.distance > 0) judge_.behind = {last + judge_.tangent.r * (down - judge_.ends[count].z) / judge_.tangent.z, down};
    return judge_;
  }

private:
  static bool rounds(const Real& x) { return x.compare(static_cast<double>(x)) != 0; }

  // The zero of h + offset near a place.
  void add_fold(double near, double offset = 0) {
    const auto function = [&](const Real& x) { return fold_function(curve_, x) + Real(offset); };
    const Real r = bisect(function, Real(near * (1 - 1e-7)), Real(near * (1 + 1e-7)));
    judge_.ends.push_back({r, curve_.value(r)});
  }

  void add_end() {
    const double distance = judge_.distance, r_max = surface_.r_max();
    Real r(r_max);
    if (surface_.r_max_limit() == RadiusLimit::domain) {
      r = Real(curve_.end);
      if (distance > 0 || r_max == curve_.end) return judge_.ends.push_back({r, curve_.value(r)});
      throw std::logic_error("the oracle knows another domain");
    }
    if (surface_.r_max_limit() == RadiusLimit::projector) return add_fold(surface_.rim().point.x, distance);
    if (distance > 0) {
      const double near = surface_.meridian(r_max)->x;
      const auto excess = [&](const Real& x) { return x * Real(distance) - Real(r_max) * (curve_.value(x) + Real(distance)); };
      const Real end(curve_.end);
      const bool stops = slope(curve_, end).is_nan() && !(Real(0) < excess(end)); // before the picture does
      r = stops ? end : bisect(excess, Real(near * (1 - 1e-7)), Real(near * (1 + 1e-7)));
    }
    judge_.ends.push_back({r, curve_.value(r)});
  }

  const ReferenceCurve& curve_;
  const Surface& surface_;
  CurveJudge<Real> judge_;
};

template <typename T>
T lens_radius(Lens lens, const T& theta) {
  switch (lens) {
  case Lens::equidistant: return theta;
  case Lens::equisolid: return sin(theta / T(2));
  case Lens::stereographic: return tan(theta / T(2));
  default: return sin(theta);
  }
}

template <typename T>
struct LensJudge {
  Lens lens;
  bool edge_is_right; // 90 degrees, which is where the cosine of a double changes its sign
  T scale, edge;
  End<T> rim, tangent;

  Oracle::Answer answer(const Direction<T>& way) const {
    const T gap = edge - atan2(way.s, way.c), none(0);
    const bool is_inside = edge_is_right ? !(way.c < none) : !(gap < none);
    const bool is_close = !edge_is_right && abs(gap) < T("1e-30");
    if (is_inside) return {PointState::visible, 0, is_close};
    const T moment = rim.z * tangent.r - rim.r * tangent.z, slant = way.c * tangent.r - way.s * tangent.z;
    const bool is_parallel = abs(slant) < T("1e-30") * (way.s + abs(way.c)); // the tangent is a difference
    return {none < moment * slant ? PointState::extended : PointState::blind, 0, is_close || is_parallel};
  }

  bool confirms(std::size_t, const Direction<T>& way, double value, double relative, double absolute) const {
    const T expected = scale * lens_radius(lens, T(atan2(way.s, way.c)));
    return !(T(value) * T(relative) + T(absolute) < abs(T(value) - expected));
  }
};

LensJudge<Rough> rough(const LensJudge<Real>& judge) {
  return {judge.lens, judge.edge_is_right, Rough(judge.scale), Rough(judge.edge), rough(judge.rim), rough(judge.tangent)};
}

Real lens_angle(Lens lens, const Real& r) {
  switch (lens) {
  case Lens::equidistant: return r;
  case Lens::equisolid: return Real(2) * asin(r);
  case Lens::stereographic: return Real(2) * atan(r);
  default: return asin(r);
  }
}

LensJudge<Real> lens_judge(Lens lens, double fov_deg, double screen) {
  const Real half = Real(fov_deg) * pi() / Real(360), scale = Real(1) / lens_radius(lens, half), step("1e-25");
  const Real edge = screen >= 1 ? half : lens_angle(lens, Real(screen) / scale);
  const auto at = [&](const Real& theta) {
    const Real r = scale * lens_radius(lens, theta);
    return End<Real>{r, r * cos(theta) / sin(theta)};
  };
  const End<Real> before = at(edge - step), after = at(edge + step);
  const End<Real> tangent{(after.r - before.r) / (step + step), (after.z - before.z) / (step + step)};
  return {lens, fov_deg == 180 && screen >= 1, scale, edge, at(edge), tangent};
}

// A judge answers for one kind of number; the oracle asks the quick one first.
template <template <typename> typename Judge>
class TwoJudges : public Oracle {
public:
  explicit TwoJudges(Judge<Real> judge) : exact_(std::move(judge)), quick_(rough(exact_)) {}

  Answer answer(const Vec3& p) const override {
    try {
      return quick_.answer(direction_of<Rough>(p));
    } catch (const Undecided&) {
      return settle(direction_of<Real>(p));
    }
  }

  bool confirms(std::size_t branch, const Vec3& p, double radius, double relative, double absolute) const override {
    try {
      return quick_.confirms(branch, direction_of<Rough>(p), radius, relative, absolute);
    } catch (const Undecided&) {
      return exact_.confirms(branch, direction_of<Real>(p), radius, relative, absolute);
    }
  }

private:
  // On an edge that is a rounded number, what lies on its two sides.
  Answer settle(const Direction<Real>& way) const {
    Answer answer = exact_.answer(way);
    if (!answer.is_close) return answer;
    const Real turn("1e-28");
    const Answer before = exact_.answer({way.s - way.c * turn, way.c + way.s * turn});
    const Answer after = exact_.answer({way.s + way.c * turn, way.c - way.s * turn});
    answer = before.state == PointState::visible ? before : after;
    answer.other = before.state == PointState::visible ? after.state : before.state;
    answer.is_close = true;
    return answer;
  }

  Judge<Real> exact_;
  Judge<Rough> quick_;
};

} // namespace

Case curve_case(const ReferenceCurve& curve, double screen, double projector) {
  Surface surface = curve_surface(curve.text, projector > 0 ? std::optional(projector) : std::nullopt, screen);
  auto oracle = std::make_unique<TwoJudges<CurveJudge>>(JudgeBuilder(curve, surface).build());
  return {describe(surface), std::move(surface), std::move(oracle)};
}

Case lens_case(Lens lens, double fov_deg, double screen) {
  SurfaceOptions options;
  options.lens = lens;
  options.fov_deg = fov_deg;
  Surface surface(options, screen);
  return {describe(surface), std::move(surface), std::make_unique<TwoJudges<LensJudge>>(lens_judge(lens, fov_deg, screen))};
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
