// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "domewarp/profile/curve.h"
#include "domewarp/profile/exact.h"
#include "domewarp/profile/lens.h"
#include "domewarp/profile/surface.h"

namespace domewarp {

/// The part of the profile curve that makes one branch. For lenses only the angles count.
struct Span {
  double r_low = 0, r_high = 0; ///< along the curve, ascending
  double z_low = 0, z_high = 0;
  double theta_at_low = 0, theta_at_high = 0;
  int orientation = 1;
  QuadPoint low{0, 0}, high{0, 0}; ///< the ends once more
  double index_at_low = 0, index_at_high = 0; ///< their half_angle_index
  static constexpr int guess_cells = 16;
  /// r at even steps of the index, where to start looking for r; none at first.
  std::vector<double> guesses{};
};

/// What a Surface consists of.
struct SurfaceParts {
  SurfaceOptions options;
  std::optional<LensForm> lens;
  Curve curve;
  double distance = 0; ///< of the projector; infinite without one
  double screen_radius = 0;
  double hidden_from = 0; ///< along the curve, see Surface::hidden_from()
  double r_max = 0;
  RadiusLimit limit = RadiusLimit::screen;
  std::vector<Branch> branches;
  std::vector<Span> spans;
  std::vector<std::vector<double>> joints;
  std::vector<Kink> kinks;
  SurfaceRim rim;
  QuadPoint rim_tangent{0, 0}; ///< the rim's tangent once more, of any length
  Vec2 rim_slope{0, 0};        ///< the same of length 1; zero at a fold
  double rim_moment = 0;       ///< cross product of the rim and that: z r' - r z'
};

/// R and z along the branch, before the projector's compensation, with derivatives in theta.
struct MeridianJet {
  RadialJet r, z;
};

/// Image radius at which the projector shows the point (r, z) of the surface.
double compensate(double distance, double r, double z);
RadialJet compensate(double distance, const MeridianJet& meridian);

/// @param point on the curve, at the angle theta.
MeridianJet curve_meridian(const Curve& curve, const Span& span, double theta, const Vec2& point);
MeridianJet lens_meridian(const LensForm& lens, double theta);

void tabulate_guesses(const Curve& curve, Span& span);

/// The point (r, z) at which the direction with sine s and cosine c meets the span, its nearer end if it does not.
Vec2 curve_point(const Curve& curve, const Span& span, double s, double c);

} // namespace domewarp
