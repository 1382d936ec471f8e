// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

/// Where the viewer is and which way the principal axis points, as asked for. Everything unset is filled in by
/// `resolve_view`.
struct ViewOptions {
  std::optional<Vec3> eye;      ///< world
  std::optional<Vec3> target;   ///< world; excludes `forward`
  std::optional<Vec3> forward;  ///< world direction
  std::optional<Vec3> up;       ///< world direction, default the camera's or +y
  std::string camera;           ///< name or index of a camera of the scene
};

/// A right-handed orthonormal frame: eye space has x right, y up and looks along -z.
struct View {
  Vec3 eye = Vec3(0);
  Vec3 right = Vec3(1, 0, 0), up = Vec3(0, 1, 0), back = Vec3(0, 0, 1);
};

/// @throws Error(usage) when a vector is not finite or zero, `up` is parallel to the view direction, both target and
/// forward are given, or the scene has no such camera.
/// Without any option: the scene's first camera, else an eye on the +z side that sees the scene's bounding sphere
/// under 90 degrees.
View resolve_view(const Scene& scene, const ViewOptions& options);

/// World to eye space, as a matrix.
Mat4 world_to_eye(const View& view);

/// One world position in eye space. Every stage uses this one function, so equal positions stay equal to the bit.
Vec3 to_eye(const View& view, const Vec3& world);

/// One vertex of an instance in world space: the only place where a mesh position meets its node's matrix.
Vec3 to_world(const Mat4& world, const Vec3f& position);

} // namespace domewarp
