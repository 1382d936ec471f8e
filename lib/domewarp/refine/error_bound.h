// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/profile/surface.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

/// How a rasteriser will interpolate between the vertices we write.
enum class Projection { perspective, orthographic };

/// A warped vertex: where it appears and the weight w of perspective output (1 for orthographic output).
struct Mapped {
  Vec2 image = Vec2(0);
  double weight = 1;
};

/// Bounds for one edge, as functions of the number n of equal parts it is cut into.
struct EdgeBound {
  double second_order = 0;   ///< L^2/8 sup |second derivative of the image error|, image units
  double image_change = 0;   ///< sup of the image speed times the angle: how far the image moves along the edge
  double weight_bend = 0;    ///< relative error of interpolating w, from its second derivative
  double weight_slope = 0;   ///< the same from its first derivative, for edges near a kink of w on the axis
  double depth = 0;          ///< relative error of the interpolated depth (distance)

  /// Largest distance between the exact image and its interpolation between neighbours of n + 1 equidistant exact points.
  double error(int n = 1) const;
};

/// Tables of suprema over theta of what the second derivative of the image needs, for one branch.
///
/// Derivation. Q(p) = w (x', y', 1) is homogeneous of degree one, so along a line at distance h from the eye
/// Q'' = (h^2 / rho^3) (S + S_psipsi) with Q = rho S and psi the arc length of the direction. A rasteriser draws the
/// linear interpolant L of Q; its error in the image is (D_xy - I D_w) / L_w, D = L - Q. Splitting off the change of the
/// image I along the edge,
///   |error| <= L^2/8 (h^2/rho^3) sup |g I_psipsi + 2 g_psi I_psi| / w_min + |Delta I| |D_w| / w_min.
/// In the frame of the meridian, with c = cos(chi) and s = sin(chi) of the heading,
///   I_psipsi + 2 (g'/g) ... = ((R'' + 2 (g'/g) R') c^2 + B s^2,  2 s c (C + (g'/g) R / sin(theta))),
///   B = (R' sin cos - R) / sin^2,  C = (R' sin - R cos) / sin^2,
/// and g = R'^(-1/2) makes the first coefficient vanish. Orthographic output has g = 1, and the term 2 h |s| / rho^4 |I_psi|
/// of the changing speed along the line instead of the weight's.
class ErrorBound {
public:
  ErrorBound(const Surface& surface, std::size_t branch, const BranchMap& map, Projection projection);

  /// @param a,b eye space, both inside the branch; wa, wb their weights
  EdgeBound edge(const Vec3& a, const Vec3& b, double wa, double wb) const;

private:
  static constexpr int cells = 1024;
  enum Quantity { radial_second, cross_second, mixed_second, slope, factor, weight_curvature, weight_gradient, quantities };
  using Row = std::array<double, quantities>;

  Row supremum(double theta_low, double theta_high) const;

  Projection projection_;
  double theta_low_, theta_high_;
  std::vector<std::vector<Row>> levels_; ///< sparse table: levels_[k][i] covers cells i .. i + 2^k - 1
};

} // namespace domewarp
