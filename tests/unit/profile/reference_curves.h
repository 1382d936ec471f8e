// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "real.h"

namespace domewarp {

/// A curve twice: as the user types it, and written out again in many digits.
struct ReferenceCurve {
  const char* text;
  Real (*value)(const Real& r);
  double end; ///< defined on [0, end] at least, and smooth inside but for `kink`
  double kink = -1;
};

/// All curves printed in the thesis and the ones that are hard for one step of the analysis or another.
inline const std::vector<ReferenceCurve>& reference_curves() {
  using R = const Real&;
  static const std::vector<ReferenceCurve> curves{
      {"1-r^2", [](R r) { return Real(1) - r * r; }, 5.0 / 3},
      {"-r+1", [](R r) { return Real(1) - r; }, 5.0 / 3},
      {"-2r+1", [](R r) { return Real(1) - Real(2) * r; }, 5.0 / 3},
      {"3-sqrt(4+6*r^2)", [](R r) { return Real(3) - sqrt(Real(4) + Real(6) * r * r); }, 5.0 / 3},
      {"sqrt(1-r^2)", [](R r) { return sqrt(Real(1) - r * r); }, 1},
      {"-r^3+r^2+r+1", [](R r) { return -(r * r * r) + r * r + r + Real(1); }, 5.0 / 3},
      {"-2.5r^2+1", [](R r) { return Real(1) - Real("2.5") * r * r; }, 5.0 / 3},
      {"2-(r+0.01)^r", [](R r) { return Real(2) - pow(r + Real("0.01"), r); }, 5.0 / 3},
      {"-log(r+0.1)", [](R r) { return -log(r + Real("0.1")); }, 5.0 / 3},
      {"-tanh(r-1)", [](R r) { return -tanh(r - Real(1)); }, 5.0 / 3},
      {"1-abs(r-.37)", [](R r) { return Real(1) - abs(r - Real(".37")); }, 5.0 / 3, 0.37},
      {"-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1",
       [](R r) {
         return Real("-0.1") * r * r * r * r + Real("2.25") * r * r + Real("0.2") * cos(Real(8) * r) + Real(1);
       },
       5.0 / 3},
  };
  return curves;
}

/// Its value on the axis is a limit, so it stands apart.
inline ReferenceCurve fisheye_curve() {
  return {"r/tan(r*pi/2)", [](const Real& r) { return r * cot(r * pi() / Real(2)); }, 5.0 / 3};
}

} // namespace domewarp
