// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/profile/surface.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"

namespace domewarp {

/// A ball in eye space.
struct Ball {
  Vec3 centre = Vec3(0);
  double radius = 0;
};

/// All directions within an angle of an axis.
struct DirectionCone {
  Vec3 axis = Vec3(0, 0, -1); ///< unit
  double half_angle = 0;      ///< radians, below pi / 2
};

/// View angles and azimuths that hold those of a cone, with room for rounding.
struct DirectionSector {
  double theta_low = 0, theta_high = 0;
  double azimuth = 0, half_azimuth = 0;
};
DirectionSector sector_of(const DirectionCone& cone);

/// Whether the part of a ring between two image radii, seen in the sector's azimuths, may meet the rectangle about the
/// image's centre.
bool meets_rectangle(const Vec2& half_extent, double radius_low, double radius_high, const DirectionSector& sector);

/// Ball around the box (space of the mesh) of a primitive drawn by an instance.
/// @param box of the primitive's positions
Ball bounding_ball(const Box& box, const Mat4& world, const View& view);

/// What the picture shows, for asking whether anything of a ball can be seen. Never wrong about what is visible.
class ViewCull {
public:
  /// @param half_extent of the picture's rectangle (kept_half_extent), image units
  ViewCull(const Surface& surface, const Vec2& half_extent);

  bool may_be_seen(const Ball& ball) const;

private:
  double radius(std::size_t branch, double theta) const;

  Surface surface_;
  Vec2 half_extent_;
};

} // namespace domewarp
