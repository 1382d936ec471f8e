// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "domewarp/profile/refuse.h"

namespace domewarp {

namespace {

constexpr int patch_degree = 10;

template <typename T>
Jet<T> evaluate_patch(const CentrePatch& patch, const T& r) {
  const double scale = 2 / patch.end;
  const T x = T(scale) * r - T(1);
  T v(0), d(0), half_dd(0);
  for (std::size_t i = patch.coefficients.size(); i-- > 0;) {
    half_dd = half_dd * x + d;
    d = d * x + v;
    v = v * x + T(patch.coefficients[i]);
  }
  return {v, d * T(scale), half_dd * T(2 * scale * scale)};
}

// Newton's divided differences at Chebyshev points, which leave out the axis, expanded into powers.
CentrePatch fit_patch(const Expression& expression, double end) {
  constexpr int count = patch_degree + 1;
  std::vector<double> nodes(count), differences(count);
  for (int i = 0; i < count; ++i) {
    nodes[i] = std::cos(std::numbers::pi * (i + 0.5) / count);
    differences[i] = evaluate(expression, 0.5 * end * (nodes[i] + 1));
  }
  for (int order = 1; order < count; ++order)
    for (int i = count - 1; i >= order; --i)
      differences[i] = (differences[i] - differences[i - 1]) / (nodes[i] - nodes[i - order]);
  CentrePatch patch{end, std::vector<double>(count, 0.0)};
  for (int i = count - 1; i >= 0; --i) {
    for (int k = count - 1; k > 0; --k)
      patch.coefficients[k] = patch.coefficients[k - 1] - nodes[i] * patch.coefficients[k];
    patch.coefficients[0] = differences[i] - nodes[i] * patch.coefficients[0];
  }
  return patch;
}

bool agrees(const CentrePatch& patch, const Expression& expression) {
  constexpr int checks = 37;
  for (int i = 1; i <= checks; ++i) {
    const double r = patch.end * i / checks;
    const double expected = evaluate(expression, r);
    if (!(std::abs(evaluate_patch(patch, r).v - expected) <= 4e-15 * std::max(1.0, std::abs(expected)))) return false;
  }
  return true;
}

std::optional<CentrePatch> patch_centre(const Expression& expression) {
  for (const double end : {0.125, 0.03125, 0.0078125, 0.001953125}) {
    CentrePatch patch = fit_patch(expression, end);
    if (agrees(patch, expression)) return patch;
  }
  return std::nullopt;
}

bool is_patched(const Curve& curve, double r) { return curve.centre && r < curve.centre->end; }

} // namespace

Curve make_curve(const std::string& expression) {
  Curve curve;
  curve.expression = compile(expression);
  const double start = evaluate(curve.expression, 0);
  if (std::isnan(start)) {
    curve.centre = patch_centre(curve.expression);
    if (curve.centre) curve.joints.push_back(curve.centre->end);
  }
  const double value = evaluate(curve, 0);
  if (!std::isfinite(value)) refuse("--curve", "f(r) has no finite value at r = 0, got " + to_text(value));
  return curve;
}

Curve make_curve(const std::vector<Vec2>& rows, const std::string& name) {
  Curve curve;
  curve.measured = fit_measured(rows, name);
  curve.joints.assign(curve.measured->r.begin() + 1, curve.measured->r.end());
  return curve;
}

double evaluate(const Curve& curve, double r) {
  if (curve.measured) return evaluate(*curve.measured, r);
  return is_patched(curve, r) ? evaluate_patch(*curve.centre, r).v : evaluate(curve.expression, r);
}

Rounded evaluate_rounded(const Curve& curve, double r) {
  if (!curve.measured && !is_patched(curve, r)) return evaluate_rounded(curve.expression, r);
  const Interval enclosed = enclose_jet(curve, Interval(r)).v;
  return {enclosed.lo, enclosed.hi - enclosed.lo};
}

Jet<double> differentiate(const Curve& curve, double r) {
  if (curve.measured) return differentiate(*curve.measured, r);
  return is_patched(curve, r) ? evaluate_patch(*curve.centre, r) : differentiate(curve.expression, r);
}

Jet<Quad> differentiate(const Curve& curve, const Quad& r) {
  if (curve.measured) return differentiate(*curve.measured, r);
  return is_patched(curve, static_cast<double>(r)) ? evaluate_patch(*curve.centre, r)
                                                   : differentiate(curve.expression, r);
}

Jet<Interval> enclose_jet(const Curve& curve, const Interval& cell) {
  if (curve.measured) return enclose_jet(*curve.measured, cell);
  return is_patched(curve, cell.lo) ? evaluate_patch(*curve.centre, cell) : enclose_jet(curve.expression, cell);
}

} // namespace domewarp
