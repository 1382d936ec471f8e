// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "domewarp/core/vectors.h"
#include "domewarp/profile/surface.h"
#include "domewarp/refine/radial_ranges.h"

namespace domewarp {

/// How a rasteriser will interpolate between the vertices we write.
enum class Projection { perspective, orthographic };

/// A warped vertex: where it appears and the weight w of perspective output (1 for orthographic output).
struct Mapped {
  Vec2 image = Vec2(0);
  double weight = 1;
};

/// What a rasteriser interpolates linearly, and what it shows of it.
inline Vec3 homogeneous(const Mapped& m) { return Vec3(m.image * m.weight, m.weight); }
inline Vec2 dehomogenise(const Vec3& q) { return Vec2(q) / q.z; }

/// A point about the eye with what bounds need of it.
struct Direction {
  Vec3 eye = Vec3(0); ///< eye space
  double rho = 0;     ///< |eye|
  double u = 0;       ///< half-angle index of theta
};
Direction direction_of(const Vec3& eye);

/// Suprema over one edge.
struct EdgeBend {
  double second = 0; ///< of |d^2 (W I) / dt^2|, t from 0 to 1 along the edge; infinite where nothing is known
  double depth = 0;  ///< of the relative error of the interpolated depth
};

/// What interpolates the depth of a face whose corners are right. With m the shares of the corners' unit directions in a
/// point's, a relative error is at most 4 (m1 m2 arch.x + m2 m3 arch.y + m3 m1 arch.z) + jump.
struct FaceDepth {
  Vec3 arch = Vec3(0);
  double jump = 0;
  double weights = 1; ///< the largest weight factor g over the smallest: by how much shares of weights exceed those of directions
};

/// Suprema over one face.
struct FaceBend {
  Vec3 second = Vec3(0); ///< of |D^2 (W I)[v, v]| for its sides v (k from corner k to k + 1): of the second derivative along every
                         ///< segment within it that is parallel to that side and as long; a quarter where it is half as long
  FaceDepth depth;       ///< if asked for
};

/// Segments between points of a small figure, a segment or a triangle.
struct ShortSegments {
  double angle = 0;                         ///< that each of them takes up at most, see small_angle
  double u_low = 0, u_high = 1;             ///< of its corners
  double weight_low = 1, weight_high = 1;   ///< of its corners
};

/// A bound of the angle (radians) that a segment of the figure takes up for the eye; infinite when the figure is not small.
/// @param longest side, @param nearest corner to the eye
double small_angle(double longest, double nearest);

/// How far the half-angle index of any point of the figure may lie outside those of its corners.
inline double u_margin(double angle) { return 0.51 * angle; } // du/dtheta <= 1/2, and every point is within the angle of a corner

/// Certified bounds of what a rasteriser's interpolation does to the image, for one branch.
///
/// Derivation. A rasteriser interpolates the homogeneous vertices w (I, 1) linearly, so at parameter t of an edge it draws
/// the point [(1 - t) w_a I_a + t w_b I_b] / W(t), W(t) = (1 - t) w_a + t w_b. Compared with the exact image I(t),
///   error(t) = (interpolant of W I - W I) / W,    |error(t)| <= t (1 - t) / 2 sup |(W I)''| / W(t),
/// where W is this linear function: the weights between the vertices do not matter, nor does how they were chosen, and
/// orthographic output is the case W = 1. With p(t) = a + t d, kappa = |a x b| / rho^2 = dpsi/dt the rate of the angle,
///   (W I)'' = kappa^2 W I_psipsi + 2 kappa c I_psi,   c = W' - W (p . d) / rho^2,
/// and in the frame of the meridian, with x = cos(chi), y = sin(chi) of the heading,
///   I_psi = (R' x, K y),   I_psipsi = (A x^2 + B y^2, 2 C x y).
/// All factors are bounded over the edge by monotone pieces in closed form; x and y by Clairaut's relation.
class ErrorBound {
public:
  ErrorBound(const Surface& surface, std::size_t branch, double theta_low, double theta_high, Projection projection)
      : projection_(projection), ranges_(surface, branch, theta_low, theta_high) {}

  /// @param wa,wb weights at the ends
  EdgeBend edge(const Direction& a, const Direction& b, double wa, double wb) const;

  FaceBend face(const std::array<const Direction*, 3>& corner, const Vec3& weights, bool with_depth) const;

  /// Half-angle indices of all points of an edge, of a face.
  Range edge_span(const Direction& a, const Direction& b) const;
  Range face_span(const Direction& a, const Direction& b, const Direction& c) const;

  /// By how much (relative) the depth of a point of a plane differs at most from that of the point of this plane whose image
  /// is `slide` away; infinite where nothing bounds it. With alpha between ray and normal, rho = distance / cos(alpha).
  /// @param span half-angle indices of the points
  /// @param farthest of them from the eye
  /// @param distance of the plane from the eye
  /// @param slide image units
  double slide_depth(const Range& span, double farthest, double distance, double slide) const;

  /// Bounds of every segment between two points of the figure, its weights linear: not as sharp as edge(), but in a fraction
  /// of the time. A figure within another never has larger bounds than that, up to rounding. Infinite when it is not small.
  EdgeBend short_segments(const ShortSegments& segments) const;

private:
  Projection projection_;
  RadialRanges ranges_;
};

/// Largest value over t in [0, 1] of [(1 - t) at_a + t at_b + t (1 - t) / 2 second] / [(1 - t) wa + t wb]: the error
/// bound of an edge whose ends are off by at_a / wa and at_b / wb already.
double peak_error(double at_a, double at_b, double second, double wa, double wb);

/// Largest value over the triangle, l barycentric, of l1 at.x + l2 at.y + l3 at.z + 4 (l1 l2 arch.x + l2 l3 arch.y +
/// l3 l1 arch.z): the error bound of a face whose corners are off by `at` and whose sides have such arches.
double peak_face(const Vec3& at, const Vec3& arch);

/// The bound of a face's relative depth error where its corners are off by `at` already.
double peak_depth(const Vec3& at, const FaceDepth& depth);

} // namespace domewarp
