// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "domewarp/profile/surface.h"

namespace domewarp {

/// What the batch kernel keeps in registers: one branch that rises from the axis, with the tangent extension and the
/// projector folded in, in single precision.
///
/// Index: u = n / (n + alpha o) with tan(theta / 2) = n / o, analytic over all directions; or, where R is even and smooth enough
/// on the axis, u = (1 - cos(theta)) / 2, which costs less. Piece round(u steps), position u steps - piece in [-1/2, 1/2],
/// so that the first piece is half as wide as the others. Value: x' = x K / rho, K = R(theta) / sin(theta); for the cosine
/// one division, scale / rho, serves both u and x'. On the tangent line x' = x / (beyond_z z + beyond_r r), which is linear even with a
/// projector, and a blind point is put at `blind_radius`.
struct FloatTable {
  static constexpr int most_powers = 8, most_pieces = 32;
  static constexpr float blind_radius = 1e4F; ///< image units: no direction is drawn farther out

  enum class Reach : char {
    cosine, ///< the index is the cosine's
    ahead,  ///< the half-angle's
    behind, ///< the half-angle's, and the last pieces hold R, which multiplies x / r: K has no bound on the backward axis
  };

  /// 8 or 16 of degree 5 or 7, 32 of degree 5, or 32 of degree 7 where fine.
  int pieces = 16, degree = 5;
  Reach reach = Reach::ahead;
  bool fine = false; ///< position in the piece in pairs of numbers; alpha is a power of 2
  float alpha = 1;
  float scale = 1;      ///< steps; half of them for the cosine
  float u_max = 0;      ///< beyond: tangent extension; -cos(theta) for the cosine
  float last_ahead = 0; ///< beyond that piece is what Reach::behind says
  float u_blind = 0;    ///< beyond: blind; -cos(theta) for the cosine
  bool line_ends = true; ///< false: what the tangent line divides by is not positive beyond u_blind, which need not be looked at
  float beyond_z = 0, beyond_r = 0;
  float g_beyond = 1;
  alignas(64) float k[most_powers][most_pieces]{}; ///< of K / scale, highest power first; the first rows are empty below degree 7
  alignas(64) float g[most_powers][most_pieces]{}; ///< of the perspective output's weight
};

/// A table with what it is expected to be off by.
struct FloatFit {
  FloatTable table;
  double approximation = 0;   ///< error of the polynomials, image units
  /// With the rounding of single precision: 1.2e-7 c + 3e-7 r_max, c = max |u dR/du| or 0.6 max sin(theta) |dK/du| for the
  /// cosine; 3.6e-7 r_max where fine.
  double predicted_error = 0;
  double weight_error = 0;    ///< relative, of g
};

/// The fastest table whose predicted error is at most a fifth of `max_error`, or else the best fine one if that is at
/// most `max_error`; nothing where there is none, or where the surface is not one branch that rises from the axis.
std::optional<FloatFit> make_float_table(const Surface& surface, double max_error);

} // namespace domewarp
