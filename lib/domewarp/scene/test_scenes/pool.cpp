// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "domewarp/scene/test_scenes/outline.h"
#include "domewarp/scene/test_scenes/scenes.h"
#include "domewarp/scene/test_scenes/solids.h"
#include "domewarp/scene/test_scenes/stage.h"

namespace domewarp::test_scenes {

namespace {

constexpr double half_width = 0.635, half_length = 1.27; ///< between the cushions
constexpr double bed_height = 0.8, ball_radius = 0.03;

Picture wall_picture() {
  return paint(64, 256, 3, [](double u, double v) {
    const double board = std::min(u * 2 - std::floor(u * 2), 1 - u * 2 + std::floor(u * 2));
    if (v > 0.97 || (v > 0.64 && v < 0.665)) return rgb(0x4a2c18);
    if (v > 0.66) return mix(rgb(0x6e4325), rgb(0x4a2c18), board < 0.04 ? 1 : 0.4 * noise(u * 16, v * 8, 16, 4));
    return mix(rgb(0x2f5d50), rgb(0x3f7566), std::floor(u * 8) - 2 * std::floor(u * 4));
  });
}

Picture landscape() {
  return paint(256, 256, 3, [](double u, double v) {
    const double far = 0.52 - 0.16 * clouds(u, 0.1, 4, 3), near = 0.72 - 0.14 * clouds(u, 0.6, 4, 8);
    if (v > near) return mix(rgb(0x4f7a33), rgb(0x2c4a1e), clouds(u, v, 16, 2));
    if (v > far) return mix(rgb(0x7f96b8), rgb(0x5d7494), ramp(far, near, v));
    return mix(mix(rgb(0x4f8fd8), rgb(0xf6d8ae), ramp(0, 0.5, v)), rgb(0xffffff), ramp(0.5, 0.8, clouds(u, v, 4, 21)));
  });
}

Picture rug_picture() {
  return paint(256, 256, 4, [](double u, double v) {
    const double edge = std::min({u, 1 - u, v, 1 - v});
    const double diamond = std::abs(u * 8 - std::floor(u * 8) - 0.5) + std::abs(v * 8 - std::floor(v * 8) - 0.5);
    Vec4 color = diamond < 0.3 ? rgb(0xd9b36a) : rgb(0x7c1f2a);
    if (edge < 0.14) color = edge < 0.06 ? rgb(0xe8dcc0) : rgb(0x23304f);
    const bool is_fringe = std::min(v, 1 - v) < 0.035;
    color.w = is_fringe && u * 42 - std::floor(u * 42) > 0.5 ? 0 : 1;
    return color;
  });
}

/// A frame whose inner opening is width x height.
Shape frame(double width, double height, double bar, int material) {
  return painted(extrude(rectangle(width + 2 * bar, height + 2 * bar), {rectangle(width, height)}, 0.12), material);
}

/// A box of 12 large triangles, two windows, a painting and a rug with fringes.
Shape pool_room(Scene& scene) {
  const int floor = add_textured(scene, "floorboards", planks(256, 8, rgb(0xb98a57), rgb(0x6a4526), 11), 0.5);
  const int wall = add_textured(scene, "wallpaper", wall_picture(), 0.9);
  const int ceiling = add_plain(scene, "plaster", 0xe9e2d2, 0.95);
  const int wood = add_plain(scene, "white wood", 0xf3ede0, 0.6);
  const int view = add_unlit(scene, "garden", landscape());
  Shape shape = room(rectangle(7, 8), 3, floor, wall, ceiling);
  shape = remapped(remapped(shape, Vec2(0), Vec2(1 / 1.2), floor), Vec2(0), Vec2(1, 1.0 / 3), wall);
  for (const double x : {-1.6, 1.6}) {
    append(shape, moved(frame(1.5, 1.2, 0.09, wood), shift(x, 1.8, -3.98)));
    append(shape, moved(painted(panel(1.56, 1.26), view), shift(x, 1.8, -3.99)));
  }
  append(shape, moved(painted(panel(2.2, 1.2), view), shift(-3.49, 1.8, 0) * turn({0, 1, 0}, 90)));
  const int rug = add_cutout(scene, "rug", rug_picture(), 1);
  append(shape, moved(painted(panel(3.6, 5), rug), shift(0, 0.006, 0) * turn({1, 0, 0}, -90)));
  return shape;
}

/// The middles of the pockets, counter-clockwise from the middle of the right cushion, and where each opens to, in
/// turns.
struct Pocket {
  Vec2 middle;
  double outward;
  bool in_corner;
};

std::vector<Pocket> pockets() {
  const double x = half_width + 0.02, y = half_length + 0.02;
  return {{{half_width + 0.045, 0}, 0, false},    {{x, y}, 0.125, true},   {{-x, y}, 0.375, true},
          {{-half_width - 0.045, 0}, 0.5, false}, {{-x, -y}, 0.625, true}, {{x, -y}, 0.875, true}};
}

/// The edge of the playing field, with keyhole-shaped pockets.
Outline cushion_outline() {
  Outline outline;
  for (const Pocket& p : pockets()) {
    const double reach = p.in_corner ? 0.4105 : 0.3525;
    const Outline hole =
        arc(p.middle, p.in_corner ? 0.09 : 0.075, p.outward - reach, p.outward + reach, p.in_corner ? 5 : 4);
    outline.insert(outline.end(), hole.begin(), hole.end());
  }
  return outline;
}

/// The bed reaches under the cushions and has a notch at each pocket.
Outline bed_outline() {
  Outline outline;
  for (const Pocket& p : pockets()) {
    const double from = p.in_corner ? 0.3562 : 0.2844;
    const Outline notch = arc(p.middle, p.in_corner ? 0.085 : 0.07, p.outward - from, p.outward - 1 + from, 4);
    outline.insert(outline.end(), notch.begin(), notch.end());
  }
  return outline;
}

Outline rail_outline() {
  const double x = half_width + 0.19, y = half_length + 0.19, cut = 0.09;
  return {{x, -y + cut}, {x, y - cut},   {x - cut, y},   {-x + cut, y},
          {-x, y - cut}, {-x, -y + cut}, {-x + cut, -y}, {x - cut, -y}};
}

bool is_in_pocket(const Vec3& p) {
  return std::abs(p.x) > half_width + 0.001 || std::abs(p.y) > half_length + 0.001;
}

Shape table(Scene& scene) {
  const int wood = add_textured(scene, "mahogany", planks(128, 1, rgb(0x8a4526), rgb(0x4a2012), 3), 0.3);
  const int felt = add_textured(scene, "felt", speckled(128, rgb(0x0f7a45), rgb(0x1a9a5a), 32, 6), 1);
  const int dark = add_plain(scene, "pocket", 0x0a0806, 1);
  const Mat4 lying = turn({1, 0, 0}, -90);
  Shape shape = moved(extrude(bed_outline(), {}, 0.03, felt, dark), shift(0, bed_height - 0.015, 0) * lying);
  Shape rails = extrude(rail_outline(), {cushion_outline()}, 0.14, wood, wood, felt);
  for (Face& face : rails)
    if (face.material == felt && is_in_pocket((face.points[0] + face.points[1] + face.points[2]) / 3.0))
      face.material = dark;
  append(shape, moved(rails, shift(0, 0.775, 0) * lying));
  const Shape body = painted(with_box_uvs(box({1.45, 0.27, 2.72}), Vec3(1)), wood);
  append(shape, moved(painted_towards(body, {0, 1, 0}, 0.9, dark), shift(0, 0.59, 0)));
  const Shape leg = painted(lathe({{0, 0}, {0.055, 0}, {0.085, 0.47}, {0, 0.47}}, 8), wood);
  for (const double x : {-0.55, 0.55})
    for (const double z : {-1.15, 1.15}) append(shape, moved(leg, shift(x, 0.008, z)));
  return shape;
}

struct Ball {
  std::string label; ///< empty for the cue ball
  std::uint32_t color;
  bool striped;
  double x, z;
};

bool is_label(const std::string& label, double x, double y) {
  const double width = 0.4 * static_cast<double>(label.size()), left = -0.5 * width;
  const double cell = (x - left) / 0.4;
  if (cell < 0 || cell >= static_cast<double>(label.size())) return false;
  const auto sign = static_cast<std::size_t>(cell);
  return is_ink(label[sign], (cell - std::floor(cell) - 0.1) / 0.8, (y + 0.35) / 0.7);
}

/// The label stands twice on the equator, in a white disc. The picture is twice as wide as high, the ball too is.
Picture ball_picture(const Ball& ball) {
  return paint(128, 64, 3, [&](double u, double v) {
    const double x = (u * 2 - std::floor(u * 2) - 0.5) * 3.6, y = (v - 0.5) * 3.6;
    const Vec4 white = rgb(0xf7f1e1), color = rgb(ball.color);
    if (x * x + y * y < 0.42) return is_label(ball.label, x, y) ? rgb(0x111111) : white;
    return ball.striped && std::abs(y) > 0.95 ? white : color;
  });
}

void add_balls(Scene& scene) {
  const std::vector<Ball> balls = {
      {"", 0xf7f1e1, false, 0.03, 0.52},  {"1", 0xf2b91c, false, -0.16, -0.05}, {"2", 0x1f3fa8, false, 0.31, -0.32},
      {"3", 0xc8281e, false, 0.12, 0.12}, {"5", 0xe8741a, false, -0.38, -0.62}, {"8", 0x15151a, false, 0.02, -0.41},
      {"9", 0xf2b91c, true, -0.42, 0.31}, {"11", 0xc8281e, true, 0.44, 0.34},   {"14", 0x1b7a3e, true, 0.2, -0.88}};
  double heading = 60;
  for (const Ball& ball : balls) {
    const int material = ball.label.empty() ? add_plain(scene, "cue ball", ball.color, 0.15)
                                            : add_textured(scene, "ball " + ball.label, ball_picture(ball), 0.15);
    const Mat4 world =
        shift(ball.x, bed_height + ball_radius + 0.0005, ball.z) * turn({0, 1, 0}, heading) * turn({1, 0, 0}, 25);
    add_object(scene, ball.label.empty() ? "cue ball" : "ball " + ball.label,
               painted(sphere(ball_radius, 12, 7), material), world);
    heading += 21;
  }
}

void add_cue(Scene& scene) {
  const int ash = add_plain(scene, "ash", 0xe3c48d, 0.35);
  const int grip = add_plain(scene, "grip", 0x241a1c, 0.6);
  const int tip = add_plain(scene, "chalk", 0x3d78c2, 1);
  Shape cue = painted(lathe({{0, 0}, {0.016, 0}, {0.014, 0.42}, {0.0065, 1.4}, {0.006, 1.42}, {0, 1.42}}, 8), ash);
  for (Face& face : cue) {
    const double low = std::min({face.points[0].y, face.points[1].y, face.points[2].y});
    if (low < 0.4) face.material = grip;
    if (low > 1.3) face.material = tip;
  }
  add_object(scene, "cue", cue, pointing({0.17, 0.985, 2.0}, {0.04, bed_height + 0.045, 0.56}));
}

/// Three green shades on a brass bar.
void add_lamp(Scene& scene) {
  const int brass = add_plain(scene, "brass", 0xd8a94a, 0.3, 1);
  Material enamel;
  enamel.name = "green shade";
  enamel.base_color = Vec4(linear(0x1c6b45), 1);
  enamel.metallic = 0;
  enamel.roughness = 0.4;
  enamel.double_sided = true;
  const int shade = add_material(scene, enamel);
  const int bulb = add_glowing(scene, "bulb", 0xfff0c8);
  Shape lamp = moved(painted(cylinder(0.02, 2, 6), brass), turn({1, 0, 0}, 90) * shift(0, -1, 0));
  for (const double z : {-0.8, 0.0, 0.8}) {
    append(lamp, moved(painted(lathe({{0.24, -0.26}, {0.05, -0.03}}, 12), shade), shift(0, 0, z)));
    append(lamp, moved(painted(sphere(0.06, 4, 2), bulb), shift(0, -0.16, z)));
  }
  for (const double z : {-0.6, 0.6}) append(lamp, moved(painted(cylinder(0.008, 1.02, 4), brass), shift(0, 0, z)));
  add_object(scene, "lamp", lamp, shift(0, 2, 0));
}

} // namespace

Scene make_pool() {
  Scene scene;
  add_object(scene, "room", pool_room(scene));
  add_object(scene, "table", table(scene));
  add_balls(scene);
  add_cue(scene);
  add_lamp(scene);
  add_camera(scene, "player", {0.28, 1.36, 1.55}, {0, 0.84, -0.2}, 70);
  add_camera(scene, "corner", {-2.6, 2, 3.2}, {0.2, 0.8, -0.3}, 60);
  for (const double z : {-0.8, 0.0, 0.8}) add_spot(scene, "bulb", {0, 1.7, z}, {0, 0, z}, 0xfff0c8, 2.5);
  add_point_light(scene, "window", {0, 1.8, -2.6}, 0xdfeaff, 9);
  add_point_light(scene, "room light", {0.8, 2.1, 2.4}, 0xffe8c8, 12);
  return scene;
}

} // namespace domewarp::test_scenes
