// SPDX-License-Identifier: Apache-2.0
// Small scenes around an eye at the origin, and the exact map applied to them by hand.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "domewarp/profile/surface.h"
#include "domewarp/render/frame.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"
#include "domewarp/transform/image_map.h"

namespace domewarp::test {

/// A display that fills the whole picture and goes on beyond its corners, so that nothing needs clipping.
struct Display {
  Raster raster;
  Surface surface;
  ImageMap map;
};
Display make_display(const std::string& curve, int width, int height);

/// A rectangle with corners a, a + u, a + u + v, a + v, two triangles, counter-clockwise seen from u x v, with
/// texture coordinates 0..uv_scale.
Mesh make_quad(const Vec3& a, const Vec3& u, const Vec3& v, int material, double uv_scale = 1);

/// Adds the mesh and an instance of it.
void add(Scene& scene, Mesh mesh, const Mat4& world = Mat4(1));

/// Adds a material of a plain colour and returns its index.
int add_material(Scene& scene, const Vec4& colour, AlphaMode mode = AlphaMode::opaque, bool double_sided = false);

/// Gives a material a texture of random opaque texels. @param wrap, filter glTF's numbers
void add_texture(Scene& scene, int material, int wrap, int filter, int size = 8);

/// Six walls of different colours, faces inwards, the eye somewhere in the middle.
Scene make_room();

/// A room with a free-standing upright board in it, the last instance.
Scene make_room_with_board();

enum class Output { perspective, orthographic };

/// Cuts every triangle into divisions^2 and maps all vertices exactly, with _SOURCE_POSITION and a camera.
Scene prewarp(const Scene& scene, const Display& display, int divisions, Output output = Output::perspective);

/// Pixels where two frames show different objects.
std::size_t count_object_differences(const Frame& a, const Frame& b);

/// Equal to the bit, NaN included.
bool is_same(const Frame& a, const Frame& b);

/// Whether one of the 8 neighbours shows another object.
bool is_outline(const Frame& frame, int column, int row);

} // namespace domewarp::test
