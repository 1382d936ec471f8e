// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "domewarp/profile/expression.h"
#include "domewarp/profile/measured.h"

namespace domewarp {

/// Stands in for an expression near the axis where it is 0/0 there (r / tan(r pi / 2)): a polynomial in 2r/end - 1.
struct CentrePatch {
  double end = 0;
  std::vector<double> coefficients;
};

/// The profile curve z = f(r), r >= 0.
struct Curve {
  Expression expression; ///< used when there is no measured curve
  std::optional<CentrePatch> centre;
  std::optional<MeasuredCurve> measured;
  std::vector<double> joints; ///< where pieces meet, ascending, > 0; enclose() must not be asked across them
};

/// @throws Error(usage) when the expression does not parse or has no finite value at r = 0.
Curve make_curve(const std::string& expression);
/// @throws Error(usage) when the rows are not as fit_measured() wants them.
Curve make_curve(const std::vector<Vec2>& rows, const std::string& name);

double evaluate(const Curve& curve, double r);
Rounded evaluate_rounded(const Curve& curve, double r); ///< with a bound of its rounding
Jet<double> differentiate(const Curve& curve, double r);
Jet<Quad> differentiate(const Curve& curve, const Quad& r);
Jet<Interval> enclose_jet(const Curve& curve, const Interval& cell);

} // namespace domewarp
