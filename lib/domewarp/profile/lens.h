// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/profile/surface.h"

namespace domewarp {

/// A closed form of R(theta), scaled so that half the field of view falls on radius 1.
struct LensForm {
  Lens lens = Lens::equidistant;
  double half_fov = 0; ///< radians
  double scale = 1;
};

/// @throws Error(usage) when the field of view is out of the lens's range.
LensForm make_lens(Lens lens, double fov_deg);

/// R for the direction with sine s and cosine c of theta.
double radius(const LensForm& form, double s, double c);
/// R, R', R''.
RadialJet radial(const LensForm& form, double theta);
/// z = R cot(theta), the profile curve that would give the same picture, with its derivatives in theta.
RadialJet depth(const LensForm& form, double theta);
/// The inverse; r in [0, 1].
double angle(const LensForm& form, double r);

} // namespace domewarp
