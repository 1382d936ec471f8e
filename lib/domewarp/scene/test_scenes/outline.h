// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "domewarp/scene/test_scenes/shape.h"

namespace domewarp::test_scenes {

/// A polygon in the plane, counter-clockwise, not closed. Holes are given counter-clockwise too.
using Outline = std::vector<Vec2>;

Outline rectangle(double width, double height);
Outline regular_polygon(double radius, int sides, double start_turns = 0);
/// `from` to `to` in turns, both included.
Outline arc(const Vec2& centre, double radius, double from, double to, int pieces);
/// Four points per tooth.
Outline gear_outline(double root_radius, double tip_radius, int teeth);
Outline shifted(Outline outline, const Vec2& by);

/// Cuts a polygon with holes into triangles without adding points: n + 2 x holes - 2 of them, n being all points.
/// @throws Error(usage) when the outline crosses itself, so that no ear is left.
std::vector<std::array<Vec2, 3>> triangulate(const Outline& outer, const std::vector<Outline>& holes);

/// A solid between z = -depth / 2 and z = depth / 2, uv = (x, -y) on the front, sides along the outline.
/// 4 x n + 4 x holes - 4 triangles.
Shape extrude(const Outline& outer, const std::vector<Outline>& holes, double depth, int face_material = 0,
              int side_material = 0, int hole_material = 0);

/// The same without the front and back: only the floor plan's inner walls, floor (y = 0) and ceiling, facing inwards.
/// uv in metres. The plan's y points to -z.
Shape room(const Outline& plan, double height, int floor_material, int wall_material, int ceiling_material);

} // namespace domewarp::test_scenes
