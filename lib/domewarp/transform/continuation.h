// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/profile/surface.h"

namespace domewarp {

/// How R(theta) goes on beyond one end of a branch: continuously differentiable, except at a fold. Chords of a rim run there,
/// and with SurfaceOptions::extension_deg geometry is drawn there.
///
/// At the outer rim, by the surface's tangent (the thesis' extension). With the rim point (r, z), the tangent (a, b), the
/// projector at D, m = z a - r b, A = a + m / D, B = b and q = cos(theta) A - sin(theta) B,
///   R = sin(theta) m / q,   R' = m A / q^2,   R'' = 2 m A (sin(theta) A + cos(theta) B) / q^3.
/// At any other end, R(theta_e) + R'(theta_e) sin(theta - theta_e), level where R' has no bound (a fold).
class Continuation {
public:
  Continuation(const Surface& surface, std::size_t branch, bool is_high);

  /// R of a direction beyond the end; >= 0, finite even towards the blind directions.
  double radius(double sine, double cosine) const;

  /// |R'| at an angle at or beyond the end.
  double slope(double theta) const;

  /// Over a range of angles beyond the end; unbounded towards the blind directions.
  RadialEnclosure enclose(double theta_low, double theta_high) const;

  /// Whether the tangent says how R goes on.
  bool is_tangent() const { return moment_ != 0; }

  /// The angle at which K has grown to 8 times that of the end, or `theta` if it does not lie beyond that.
  double before_blind(double theta) const;

private:
  double theta_ = 0, sine_ = 0, cosine_ = 1; ///< of the end
  double radius_ = 0, slope_ = 0;
  double moment_ = 0, a_ = 0, b_ = 0, q_ = 1; ///< q at the end
};

/// The part of a branch that is drawn: with SurfaceOptions::extension_deg, the rim is farther out, though not so far that K
/// grows to more than 8 times its value at r_max.
Branch drawn_branch(const Surface& surface, std::size_t branch);

} // namespace domewarp
