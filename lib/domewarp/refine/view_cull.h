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

/// Ball around the box (space of the mesh) of a primitive drawn by an instance.
/// @param box of the primitive's positions
Ball bounding_ball(const Box& box, const Mat4& world, const View& view);

/// What the picture shows, for asking whether anything of a ball can be seen. Never wrong about what is visible.
class ViewCull {
public:
  /// @param margin by which the picture's rectangle is widened, image units
  ViewCull(const Surface& surface, const Raster& raster, double margin);

  bool may_be_seen(const Ball& ball) const;

private:
  bool meets_rectangle(double radius_low, double radius_high, double azimuth, double half_azimuth) const;

  Surface surface_;
  Vec2 half_extent_;
};

} // namespace domewarp
