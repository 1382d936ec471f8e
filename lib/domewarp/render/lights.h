// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

/// A punctual light (KHR_lights_punctual) in the space that shading is done in.
struct PlacedLight {
  LightKind kind = LightKind::point;
  Vec3 position = Vec3(0);
  Vec3 direction = Vec3(0, 0, -1);       ///< unit, where it shines
  Vec3 strength = Vec3(1);               ///< colour times intensity
  double range = 0;                      ///< 0 for no limit
  double cone_scale = 0, cone_offset = 1; ///< cone = clamp(cos(angle) scale + offset, 0, 1)^2
};

/// The lights of a scene. @param from_world rigid, from world space to eye or camera space
std::vector<PlacedLight> place_lights(const Scene& scene, const Mat4& from_world);

/// What a light does at a point.
struct Arrival {
  Vec3 towards = Vec3(0);    ///< unit, to the light; zero when the point is at the light
  double distance = std::numeric_limits<double>::infinity();
  Vec3 irradiance = Vec3(0); ///< on a surface that faces the light; lux
};
Arrival arrival(const PlacedLight& light, const Vec3& point);

} // namespace domewarp
