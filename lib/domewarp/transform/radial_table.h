// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "domewarp/profile/half_angle.h"
#include "domewarp/profile/surface.h"

namespace domewarp {

/// R / u and the weight g over the half-angle index u = n / (n + o), where tan(theta / 2) = n / o: analytic in theta
/// from axis to axis, and needs no arctangent. Segments end where R is not smooth; towards a fold, where R has a square
/// root, they are measured by the root of the distance to it. Each segment is halved until its pieces are exact, and an
/// even grid of cells as fine as its smallest piece says which piece a place belongs to.
struct RadialTable {
  static constexpr int degree = 9;
  enum class Grading : char { even, to_low, to_high };

  struct Segment {
    double u_low = 0, u_high = 0;
    double scale = 0; ///< 1 / (u_high - u_low)
    Grading grading = Grading::even;
    double cells = 1;           ///< how many, a power of two
    std::size_t first_cell = 0; ///< in RadialTable::cells
  };

  /// A polynomial in x = (v - low) scale - 1, from -1 to 1; v is the place in the segment, 0 to 1.
  struct Piece {
    double low = 0, scale = 2;
    std::array<double, 2 * (degree + 1)> coefficients{}; ///< per power, highest first: R / u, g
  };

  std::vector<Segment> segments;
  std::vector<Piece> pieces;
  std::vector<std::uint32_t> cells; ///< index of the piece
  double max_error = 0;             ///< of R, measured between the nodes; infinite where no table was tried
  bool qualifies = false;           ///< max_error is within what a table is allowed
};

struct TableValue {
  double ratio = 0; ///< R / u
  double g = 1;
  bool fine = true; ///< false next to a fold, where u itself is too coarse: ask the direct method for R
};

RadialTable make_radial_table(const Surface& surface, std::size_t branch);
TableValue look_up(const RadialTable& table, double u);

} // namespace domewarp
