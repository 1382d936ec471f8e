// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "domewarp/scene/test_scenes/outline.h"
#include "domewarp/scene/test_scenes/scenes.h"
#include "domewarp/scene/test_scenes/solids.h"
#include "domewarp/scene/test_scenes/stage.h"

namespace domewarp::test_scenes {

namespace {

/// An octagon of 28 triangles, 14 m across, open to the sky.
Shape octagon_room(Scene& scene) {
  const int floor = add_textured(scene, "tiles", tiles(128, 2, rgb(0xf2efe6), rgb(0x2b2d33), rgb(0x8a8a86)), 0.35);
  const int wall = add_textured(scene, "bricks", bricks(256, rgb(0xc9825f), rgb(0xd8cfc0)), 0.95);
  const int ceiling = add_unlit(scene, "sky", sky(256, 256, rgb(0x3f7fd0), rgb(0xa9d2f3), rgb(0xffffff)));
  const Shape shape = room(regular_polygon(7, 8, 1.0 / 16), 4.5, floor, wall, ceiling);
  return remapped(shape, Vec2(0.5), Vec2(1.0 / 14), ceiling);
}

Picture crate_picture() {
  return paint(128, 128, 3, [grain = planks(128, 4, rgb(0xd9ab6b), rgb(0x8a5a2b), 7)](double u, double v) {
    const auto pixel = 3 * (static_cast<std::size_t>(v * 128) * 128 + static_cast<std::size_t>(u * 128));
    const double edge = std::min({u, 1 - u, v, 1 - v}), brace = std::abs(u - v);
    const double shade = edge < 0.1 ? 0.82 : edge < 0.12 ? 0.45 : brace < 0.08 ? 0.78 : brace < 0.1 ? 0.45 : 1;
    return Vec4(grain.samples[pixel], grain.samples[pixel + 1], grain.samples[pixel + 2], 255) * (shade / 255);
  });
}

Picture dots_picture() {
  return paint(128, 128, 3, [](double u, double v) {
    const double x = u * 4 - std::floor(u * 4) - 0.5, y = v * 4 - std::floor(v * 4) - 0.5;
    return x * x + y * y < 0.09 ? rgb(0xfff4d0) : rgb(0x1f9d55);
  });
}

Picture lattice_picture() {
  return paint(128, 128, 4, [](double u, double v) {
    const double x = std::abs(u * 5 - std::floor(u * 5) - 0.5), y = std::abs(v * 5 - std::floor(v * 5) - 0.5);
    Vec4 color = mix(rgb(0x7b3fb5), rgb(0xd08bff), v);
    color.w = std::max(x, y) > 0.34 ? 1 : 0;
    return color;
  });
}

Mat4 standing(double x, double z, double size, double heading) {
  return shift(x, 0.5 * size + 0.002, z) * turn({0, 1, 0}, heading);
}

Shape cube(double size, int material) {
  return painted(bevelled_box(Vec3(size), 0.06 * size), material);
}

void add_rainbow(Scene& scene) {
  const int white = add_plain(scene, "white", 0xffffff, 0.5);
  const auto hue = [](const Vec3& p) { return Vec3(0.5) + p * 0.9; };
  const Mat4 balanced = shift(0.3, 2.25, -3.6) * turn({0, 1, 0}, 20) * turn({1, 0, -1}, 54.7356);
  add_object(scene, "rainbow cube", cube(1, white), balanced, hue);
}

void add_cubes(Scene& scene) {
  const int red = add_plain(scene, "red", 0xd8342b, 0.25);
  const int gold = add_plain(scene, "gold", 0xf2c14a, 0.3, 1);
  const int blue = add_plain(scene, "blue", 0x2f62d9, 0.6);
  add_object(scene, "red cube", cube(1.1, red), standing(-1.5, -2.6, 1.1, 25));
  add_object(scene, "crate", cube(1.3, add_textured(scene, "crate", crate_picture(), 0.8)),
             standing(0.2, -3.6, 1.3, -12));
  add_rainbow(scene);
  add_object(scene, "golden cube", cube(0.9, gold), standing(1.9, -1.9, 0.9, -35));
  add_object(scene, "lattice", cube(1.2, add_cutout(scene, "lattice", lattice_picture(), 0.5)),
             standing(-2.7, 0.3, 1.2, 50));
  add_object(scene, "dotted cube", cube(1.2, add_textured(scene, "dots", dots_picture(), 0.5)),
             standing(2.7, 0.8, 1.2, 15));
  add_object(scene, "blue cube", cube(1, blue), standing(-0.4, 3.1, 1, 40));
}

} // namespace

Scene make_cubes() {
  Scene scene;
  add_object(scene, "room", octagon_room(scene));
  add_cubes(scene);
  add_camera(scene, "middle of the room", {0, 1.5, 0.4}, {0.1, 1.1, -3}, 70);
  add_camera(scene, "corner", {-4.2, 2.6, 4.2}, {0.5, 0.6, -1.5}, 60);
  add_point_light(scene, "sky light", {2, 4.2, 1.5}, 0xfff6e6, 30);
  add_point_light(scene, "lamp", {-2.5, 3.4, -1}, 0xffe2b8, 14);
  return scene;
}

} // namespace domewarp::test_scenes
