// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/scene/raster.h"
#include "domewarp/scene/view.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

/// What a warped file says about the picture it draws.
struct Picture {
  Surface surface;
  ImageMap map;                  ///< of the surface, by the direct method
  View view;
  Raster raster;
  bool perspective = true;       ///< else orthographic
  double near = 0;               ///< nothing nearer to the eye was drawn
  double rim_px = 0.5;           ///< by how much a rim may be flatter than its circle, for its chords: the tolerance
};

/// Where a written position appears, image units.
inline Vec2 drawn_at(const Vec3& position, bool perspective) { return perspective ? Vec2(position) / -position.z : Vec2(position); }

/// The eye-space point that a written position stands for: the warp backwards, by rays.
Vec3 source_of(const Picture& picture, const Vec3& position);

/// Whether a point is within `margin` (radians, image units, or relative distance) of anything that clips the branch.
bool is_at_boundary(const Picture& picture, std::size_t branch, const Vec3& eye, double margin);

/// Whether a point appears within `rim_px` of a circle that ends the branch's image.
bool is_near_rim(const Picture& picture, std::size_t branch, const Vec3& eye);

/// Smallest distance (radians) of a direction from an end of the branch that clips, positive inside.
double inside_angles(const Branch& branch, const Vec3& eye);

/// Whether a branch shows an eye-space point on the picture, at least `margin` inside of all that clips.
bool is_shown(const Picture& picture, std::size_t branch, const Vec3& eye, double margin);

/// Pixels^2 of the picture per steradian around an eye-space point.
double pixels_per_steradian(const Picture& picture, std::size_t branch, const Vec3& eye);

} // namespace domewarp
