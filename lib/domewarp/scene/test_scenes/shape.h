// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/scene.h"

/// Modelling for the bundled test scenes. Everything is built from +, -, *, / and square roots, which IEEE 754 rounds
/// alike everywhere, so no result depends on a machine's mathematics library.
namespace domewarp::test_scenes {

inline constexpr double pi = 3.141592653589793;

/// Cosine of the angle between two faces up to which their common edge is shaded smooth: about 41 degrees.
inline constexpr double usual_crease = 0.75;

/// One triangle, counter-clockwise seen from outside.
struct Face {
  std::array<Vec3, 3> points;
  std::array<Vec2, 3> uvs;
  int material = 0;
  double crease = usual_crease; ///< faces whose normals meet at a larger cosine are shaded smooth; 1 for flat
};

/// Triangles that know nothing of each other: equal positions make them neighbours.
using Shape = std::vector<Face>;

/// (cosine, sine) of an angle in turns.
Vec2 circle(double turns);

/// The nearest point of the grid that all positions lie on.
Vec3 on_grid(const Vec3& p);
Vec2 on_grid(const Vec2& p);

Mat4 shift(double x, double y, double z);
Mat4 stretch(double x, double y, double z);
Mat4 turn(const Vec3& axis, double degrees);
/// Moves the origin to `base` and turns the y axis towards `tip`.
Mat4 pointing(const Vec3& base, const Vec3& tip);

/// Normal, twice as long as the triangle's area.
Vec3 area_normal(const Face& face);

void append(Shape& shape, const Shape& more);

/// Two triangles a b c and a c d. One whose corners coincide is left out, so that poles close properly.
void append_quad(Shape& shape, const std::array<Vec3, 4>& points, const std::array<Vec2, 4>& uvs);

Shape moved(Shape shape, const Mat4& matrix);
Shape painted(Shape shape, int material);
Shape creased(Shape shape, double crease);
Shape turned_inside_out(Shape shape);
/// uv -> offset + uv * scale, for the faces of one material or, with -1, for all.
Shape remapped(Shape shape, const Vec2& offset, const Vec2& scale, int material = -1);
/// Projects each face along the axis nearest to its normal; `size` metres make one repetition of the texture.
Shape with_box_uvs(Shape shape, const Vec3& size);
/// Gives faces by their normals: those within the cosine `limit` of `direction` get `material`.
Shape painted_towards(Shape shape, const Vec3& direction, double limit, int material);

using ColorAt = std::function<Vec3(const Vec3& position)>; ///< linear 0..1

/// One primitive per material in ascending order. Corners that agree in position, normal and texture coordinate share a
/// vertex. @param color fills COLOR_0 when set.
Mesh make_mesh(const std::string& name, const Shape& shape, const ColorAt& color = {});

} // namespace domewarp::test_scenes
