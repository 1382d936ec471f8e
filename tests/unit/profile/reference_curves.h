// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "real.h"
#include "rough.h"

namespace domewarp {

/// A curve three times: as the user types it, and written out again in many digits and in few with a bound of the error.
struct ReferenceCurve {
  const char* text;
  Real (*value)(const Real& r);
  Rough (*rough)(const Rough& r);
  double end; ///< defined on [0, end] at least, and smooth inside but for `kink`
  double kink = -1;

  Real at(const Real& r) const { return value(r); }
  Rough at(const Rough& r) const { return rough(r); }
};

/// @param f takes a number of either kind
template <typename Function>
ReferenceCurve reference_curve(const char* text, Function f, double end, double kink = -1) {
  return {text, f, f, end, kink};
}

/// All curves printed in the thesis and the ones that are hard for one step of the analysis or another.
inline const std::vector<ReferenceCurve>& reference_curves() {
  static const std::vector<ReferenceCurve> curves{
      reference_curve("1-r^2", []<typename T>(const T& r) { return T(1) - r * r; }, 5.0 / 3),
      reference_curve("-r+1", []<typename T>(const T& r) { return T(1) - r; }, 5.0 / 3),
      reference_curve("-2r+1", []<typename T>(const T& r) { return T(1) - T(2) * r; }, 5.0 / 3),
      reference_curve("3-sqrt(4+6*r^2)", []<typename T>(const T& r) { return T(3) - sqrt(T(4) + T(6) * r * r); }, 5.0 / 3),
      reference_curve("sqrt(1-r^2)", []<typename T>(const T& r) { return sqrt(T(1) - r * r); }, 1),
      reference_curve("-r^3+r^2+r+1", []<typename T>(const T& r) { return -(r * r * r) + r * r + r + T(1); }, 5.0 / 3),
      reference_curve("-2.5r^2+1", []<typename T>(const T& r) { return T(1) - T("2.5") * r * r; }, 5.0 / 3),
      reference_curve("2-(r+0.01)^r", []<typename T>(const T& r) { return T(2) - pow(r + T("0.01"), r); }, 5.0 / 3),
      reference_curve("-log(r+0.1)", []<typename T>(const T& r) { return -log(r + T("0.1")); }, 5.0 / 3),
      reference_curve("-tanh(r-1)", []<typename T>(const T& r) { return -tanh(r - T(1)); }, 5.0 / 3),
      reference_curve("1-abs(r-.37)", []<typename T>(const T& r) { return T(1) - abs(r - T(".37")); }, 5.0 / 3, 0.37),
      reference_curve("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1",
                      []<typename T>(const T& r) {
                        return T("-0.1") * r * r * r * r + T("2.25") * r * r + T("0.2") * cos(T(8) * r) + T(1);
                      },
                      5.0 / 3),
  };
  return curves;
}

/// Its value on the axis is a limit, so it stands apart.
inline ReferenceCurve fisheye_curve() {
  return reference_curve("r/tan(r*pi/2)", []<typename T>(const T& r) { return r * cot(r * T(pi()) / T(2)); }, 5.0 / 3);
}

} // namespace domewarp
