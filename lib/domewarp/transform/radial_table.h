// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "domewarp/profile/surface.h"

namespace domewarp {

/// R / u and the weight g over the half-angle index u = n / (n + o), where tan(theta / 2) = n / o: analytic in theta
/// from axis to axis, and needs no arctangent. Segments end where R is not smooth; towards a fold, where R has a square
/// root, pieces are even in the root of the distance to it.
struct RadialTable {
  static constexpr int degree = 9;
  enum class Grading : char { even, to_low, to_high };

  struct Segment {
    double u_low = 0, u_high = 0;
    double scale = 0; ///< 1 / (u_high - u_low)
    Grading grading = Grading::even;
    int pieces = 1;
    std::size_t first = 0; ///< index of the first piece
  };

  std::vector<Segment> segments;
  std::vector<double> coefficients; ///< per piece and power, highest first: R / u, g
  double max_error = 0;             ///< of R, measured between the nodes
  bool qualifies = false;           ///< max_error is within what a table is allowed
};

/// u for a direction; s = sin(theta), c = cos(theta) or any positive multiple of both, `length` their hypotenuse.
inline double half_angle_index(double s, double c, double length) {
  const double a = length + (c < 0 ? -c : c);
  return c < 0 ? a / (a + s) : s / (s + a);
}

struct TableValue {
  double ratio = 0; ///< R / u
  double g = 1;
  bool fine = true; ///< false next to a fold, where u itself is too coarse: ask the direct method for R
};

RadialTable make_radial_table(const Surface& surface, std::size_t branch);
TableValue look_up(const RadialTable& table, double u);

} // namespace domewarp
