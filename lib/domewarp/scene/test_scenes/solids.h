// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "domewarp/scene/test_scenes/shape.h"

namespace domewarp::test_scenes {

using PointAt = std::function<Vec3(int row, int column)>;

/// rows x columns quads with uv in 0..1. Columns run to the right and rows upwards, seen from outside.
Shape grid(int rows, int columns, const PointAt& point);

/// A rectangle around the origin that faces +z, uv (0, 0) at its top left. 2 triangles.
Shape panel(double width, double height);
/// Around the origin, the texture once on each side. 12 triangles.
Shape box(const Vec3& size);
/// A box with its edges and corners cut off. 44 triangles.
Shape bevelled_box(const Vec3& size, double bevel);

/// Turns (radius, height) points, from the bottom up along the outside, around the y axis. u runs once around, v along
/// the profile by length. 2 x sides triangles per piece, half as many where it touches the axis.
Shape lathe(const std::vector<Vec2>& profile, int sides);
Shape cylinder(double radius, double height, int sides);
Shape sphere(double radius, int sides, int rings);
/// Lies in the xz plane. 2 x sides x tube_sides triangles.
Shape torus(double radius, double tube_radius, int sides, int tube_sides);
/// An icosahedron cut into 20 x frequency^2 triangles.
Shape icosphere(double radius, int frequency);

/// A pipe along a path with flat ends. One radius per point of the path. 2 x sides triangles per point.
Shape tube(const std::vector<Vec3>& path, const std::vector<double>& radii, int sides);
/// A pipe along a closed path, which must lie in a plane.
Shape loop_tube(const std::vector<Vec3>& path, double radius, int sides);

/// A screw thread around the y axis from y = 0 up, between the two radii; it begins and ends in a step.
/// Height: pitch x (turns + 2). 4 x sides x turns + 6 x sides + 4 triangles.
Shape screw_thread(double core_radius, double crest_radius, double pitch, int turns, int sides);

} // namespace domewarp::test_scenes
