// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/core/vectors.h"
#include "domewarp/profile/curve.h"
#include "domewarp/profile/surface.h"

namespace domewarp {

/// A point or direction (r, z) in profile space to 30 digits.
struct QuadPoint {
  Quad r, z;
};

/// An eye-space point about the principal axis: r exact to 34 digits, z forward.
QuadPoint about_axis(const Vec3& p);

/// Sign of sin(theta - theta of `end`): +1 where the direction is farther from the forward axis, up to pi.
int side_of(const QuadPoint& end, const QuadPoint& direction);

QuadPoint point_on(const Curve& curve, const Quad& r);

/// The functions below find again, to 30 digits, what the analysis found as a double `r`.

/// Where h + offset changes sign; r itself when it does not do so near r.
QuadPoint refine_fold(const Curve& curve, double r, double offset);
/// Where f stops being defined or continuous.
QuadPoint refine_domain_end(const Curve& curve, double r);
/// Where the compensated radius is `picture`.
QuadPoint refine_picture_end(const Curve& curve, double r, double distance, double picture);

/// Where the direction meets the curve between two of its points; the nearer of these when it does not.
/// @param orientation of the branch between them. @param guess of r.
QuadPoint meet(const Curve& curve, const QuadPoint& low, const QuadPoint& high, int orientation,
               const QuadPoint& direction, double guess);

/// Where the visible part of a lens's surface ends and the tangent there, of any length.
struct LensEnd {
  QuadPoint point, tangent;
};

/// @param theta of that end. @param picture image radius that cuts the lens there; infinite when it shows it whole.
LensEnd refine_lens_end(Lens lens, double fov_deg, double theta, double distance, double picture);

} // namespace domewarp
