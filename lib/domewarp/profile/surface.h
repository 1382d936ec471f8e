// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/profile/interval.h"

namespace domewarp {

enum class Lens { equidistant, equisolid, stereographic, orthographic };
const char* to_string(Lens lens);

/// Which crossings of a view ray with a multi-valued curve are drawn.
enum class BranchChoice { all, first };

/// A display that is symmetric about its axis, as asked for. Exactly one of `curve`, `lens`, `profile` is given.
struct SurfaceOptions {
  std::string curve;             ///< z = f(r) as an expression in r
  std::optional<Lens> lens;
  double fov_deg = 180;          ///< full field of view of the lens; its edge falls on image radius 1
  std::vector<Vec2> profile;     ///< measured rows (r, z), r strictly increasing from 0, shape-preserving cubic
  double profile_unit = 1;       ///< length in the file that is one image unit; `profile` has been divided by it
  std::string profile_name;      ///< file the rows came from, for messages
  std::optional<double> rmax;    ///< image radius the user wants to see at most
  std::optional<double> projector; ///< distance of the projector behind the eye, image units
  BranchChoice branches = BranchChoice::all;
  double extension_deg = 0;      ///< geometry goes on so far beyond r_max, along the tangent; the picture ends at r_max
};

/// The image radius as a function of the view angle theta (0 forward, pi backward) with its derivatives.
struct RadialJet {
  double r = 0;                  ///< image radius R, after the projector's compensation
  double dr = 0, d2r = 0;        ///< R', R'' with respect to theta
};

/// Intervals that are certain to contain R, R' and R'' over a range of angles; unbounded where no bound is known (R'
/// beside a fold, R'' at a kink or a vertical tangent).
struct RadialEnclosure {
  Interval r, dr, d2r;
};

/// One monotone piece of R(theta): the directions theta_low..theta_high and the image radii they fill. R rises with
/// theta where `orientation` is +1 and falls where it is -1 (h = f - r f' < 0; triangles there appear mirrored).
struct Branch {
  double theta_low = 0, theta_high = 0; ///< radians, theta_low < theta_high
  double radius_low = 0, radius_high = 0; ///< image radii at theta_low and theta_high; low > high where falling
  int orientation = 1;
  bool fold_low = false, fold_high = false; ///< the view angle turns at that end; R' is infinite unless it is a corner
};

/// What stopped the picture from growing beyond r_max.
enum class RadiusLimit { user, screen, domain, fold, projector, lens };
const char* to_string(RadiusLimit limit);

/// How the surface fails to be smooth somewhere.
enum class KinkKind { corner, vertical_tangent, joint };
const char* to_string(KinkKind kind);

/// A place where the profile curve is continuous but not smooth: a corner, a vertical tangent, a row of a measured
/// profile.
struct Kink {
  double r = 0, z = 0;     ///< on the surface
  double image_radius = 0; ///< after compensation
  double theta = 0;        ///< radians
  KinkKind kind = KinkKind::corner;
};

/// Directions theta_low..theta_high (radians) in which nothing is shown, not even by the tangent extension. Around the
/// backward axis on a surface that starts in front of the eye, around the forward axis on one that starts behind.
struct BlindCone {
  double theta_low = 0, theta_high = 0;
};

/// Where the visible part of the surface ends, and how it would go on.
struct SurfaceRim {
  Vec2 point{0, 0};   ///< (r, z)
  Vec2 tangent{0, 0}; ///< (dr, dz), unit, outwards; zero at a fold, where the last ray touches the surface
};

struct SurfaceParts;

/// A profile curve, lens or measured profile with its projector, analysed: everything about the display that the rest
/// of the toolkit needs, as one radial function per branch. Immutable, cheap to copy, safe to share between threads.
/// Based on: sections (d), (e), (f) of the thesis' mathematics; theta(r) = atan2(r, f(r)), theta' = h / (r^2 + f^2).
class Surface {
public:
  /// @param screen_radius image radius of the picture's corners (see scene/raster.h)
  /// @throws Error(usage) when the expression does not parse (naming the column and what was expected), the surface
  ///         shows nothing (nowhere defined, the eye on it, f(0) <= 0 with mixed signs of h), it is too irregular to be
  ///         analysed, or a number is out of range.
  Surface(const SurfaceOptions& options, double screen_radius);

  const SurfaceOptions& options() const;
  double r_max() const;                  ///< largest image radius that shows anything (after compensation)
  RadiusLimit r_max_limit() const;
  const std::vector<Branch>& branches() const;
  /// Angles inside the branch at which R is continuous but not smooth (kinks of the curve, joints of a measured
  /// profile), ascending.
  const std::vector<double>& joints(std::size_t branch) const;

  /// The direct method: R for the direction with sine `s` >= 0 and cosine `c` of theta (s^2 + c^2 = 1), by a bracketed,
  /// safeguarded root of F(r) = f(r) s - r c (closed form for lenses), residual at double rounding. Directions
  /// outside the branch give the radius at its nearer end.
  double radius(std::size_t branch, double s, double c) const;

  /// The same for an eye-space point, finite and not zero, to 1e-13 of R for every direction: where rounding could move
  /// R by more (beside a fold, in a curve that cancels) it is settled with 113 bits.
  double radius(std::size_t branch, const Vec3& p) const;

  /// Whether the branch shows the direction of an eye-space point, finite and not zero: exact, in 113 bits.
  bool shows(std::size_t branch, const Vec3& p) const;

  /// R, R', R'' at theta, clamped to the branch. Infinite slopes (fold) come back as the largest finite value.
  RadialJet radial(std::size_t branch, double theta) const;

  /// The same for an eye-space point, finite and not zero, with the R of radius(branch, p): one root for all three.
  RadialJet radial(std::size_t branch, const Vec3& p) const;

  /// Enclosures over [theta_low, theta_high], clamped to the branch: R' and R'' contain the one-sided derivatives at kinks.
  RadialEnclosure enclose(std::size_t branch, double theta_low, double theta_high) const;

  /// The tangent extension beyond r_max in homogeneous form (valid for vertical tangents): image radius for an eye-space
  /// point whose direction no branch shows, after compensation; nothing for a blind direction. In 113 bits where the
  /// rounding of doubles could decide, else to 1e-13.
  std::optional<double> extended_radius(const Vec3& p) const;

  /// The inverse, for rays: sine and cosine of theta of the direction seen at an image radius (corrected Eq. 25
  /// when there is a projector); nothing beyond r_max.
  std::optional<Vec2> direction(double image_radius) const;

  /// Index of the branch that image radius belongs to (0 for radii outside).
  std::size_t branch_at(double image_radius) const;

  /// The point (r, z) of the surface that is seen at an image radius (before the projector's compensation); nothing
  /// beyond r_max.
  std::optional<Vec2> meridian(double image_radius) const;

  /// Empty (both angles pi) when some branch shows the direction straight behind.
  BlindCone blind() const;

  SurfaceRim rim() const;

  /// Kinks of the visible part, ascending in r, each analysed from the slopes on its two sides.
  const std::vector<Kink>& kinks() const;

  /// Radius along the curve beyond which the projector lights nothing, because its rays touch the surface there and
  /// what lies further out is behind it; infinite where it lights the whole surface.
  double hidden_from() const;

  double screen_radius() const; ///< image radius of the picture's corners, as given

private:
  std::shared_ptr<const SurfaceParts> parts_; ///< immutable, so copies share them
};

} // namespace domewarp
