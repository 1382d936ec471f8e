// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include <glm/common.hpp>

#include "domewarp/scene/test_scenes/outline.h"
#include "domewarp/scene/test_scenes/scenes.h"
#include "domewarp/scene/test_scenes/solids.h"
#include "domewarp/scene/test_scenes/stage.h"
#include "domewarp/scene/test_scenes/toy_models.h"

namespace domewarp::test_scenes {

namespace {

constexpr std::array<std::uint32_t, 7> rainbow = {0xd9342b, 0xee7f1d, 0xf5c723, 0x3fa648, 0x2aa3c9, 0x3457c4, 0x8a3fb0};
constexpr double track_radius = 3.1, rail_height = 0.081;

/// Stars in the sky above, stripes below.
Picture nursery_wall() {
  return paint(128, 256, 3, [](double u, double v) {
    if (v > 0.96) return rgb(0xffffff);
    if (v > 0.68) return v < 0.695 ? rgb(0xffffff) : static_cast<int>(u * 6) % 2 ? rgb(0xe9c46a) : rgb(0xf4dfae);
    const double x = u * 4 + 0.5 * (static_cast<int>(v * 8) % 2), dx = x - std::floor(x) - 0.5,
                 dy = v * 8 - std::floor(v * 8) - 0.5;
    return dx * dx + dy * dy < 0.012 ? rgb(0xfdf3c4) : mix(rgb(0x6fb7e3), rgb(0xb5dcf0), v / 0.68);
  });
}

Picture night() {
  return paint(256, 256, 3, [](double u, double v) {
    const double dx = u - 0.68, dy = v - 0.28, hill = 0.8 - 0.12 * clouds(u, 0.4, 4, 6);
    if (v > hill) return rgb(0x1c2f2a);
    if (dx * dx + dy * dy < 0.008) return rgb(0xfff6d2);
    const double star = noise(u * 64, v * 64, 64, 77);
    return star > 0.93 ? rgb(0xf0f4ff) : mix(rgb(0x10184a), rgb(0x4b5fa8), v);
  });
}

Shape nursery(Scene& scene) {
  const int floor =
      add_textured(scene, "black and white tiles", tiles(128, 2, rgb(0xf4f2ea), rgb(0x1d1d22), rgb(0x77777a)), 0.3);
  const int wall = add_textured(scene, "nursery wallpaper", nursery_wall(), 0.95);
  const int ceiling = add_plain(scene, "ceiling", 0xf1ece0, 0.95);
  const int white = add_plain(scene, "white paint", 0xf8f5ee, 0.5);
  const int sky = add_unlit(scene, "night", night());
  Shape shape = room(rectangle(9.6, 9.6), 4.2, floor, wall, ceiling);
  shape = remapped(remapped(shape, Vec2(0), Vec2(0.625), floor), Vec2(0), Vec2(0.5, 1 / 4.2), wall);
  for (const double side : {-1.0, 1.0}) {
    const Mat4 at = shift(side * 4.8, 2.4, -1.2) * turn({0, 1, 0}, -90 * side);
    append(shape, moved(painted(extrude(rectangle(2.2, 2), {rectangle(2, 1.8)}, 0.16), white), at));
    append(shape, moved(painted(panel(2.06, 1.86), sky), at * shift(0, 0, 0.01)));
  }
  append(shape, moved(painted(box({1.5, 3, 0.1}), white), shift(2.4, 1.502, 4.78)));
  const int poster = add_textured(scene, "alphabet", letter(128, 'A', rgb(0xc92a2a), rgb(0xfff4d6)), 0.9);
  append(shape, moved(painted(panel(1.2, 1.2), poster), shift(-1.5, 2, 4.79) * turn({0, 1, 0}, 180)));
  return shape;
}

/// The letter is on all six sides.
int block_mesh(Scene& scene, std::map<char, int>& meshes, char sign) {
  const auto known = meshes.find(sign);
  if (known != meshes.end()) return known->second;
  const std::string name = std::string("block ") + sign;
  const Picture picture = letter(64, sign, rgb(rainbow[static_cast<std::size_t>(sign) % 7]), rgb(0xf1d9a8));
  const int material = add_textured(scene, name, picture, 0.6);
  const int mesh = add_mesh(scene, name, painted(bevelled_box(Vec3(0.3), 0.02), material));
  return meshes[sign] = mesh;
}

struct Block {
  char sign;
  double x, y, z, heading;
};

/// A row with the name of this toolkit, a pyramid, a tower and two strays.
std::vector<Block> block_places() {
  std::vector<Block> blocks;
  const std::string row = "DOMEWARP", pyramid = "MAPRED", tower = "WDEO";
  for (std::size_t i = 0; i < row.size(); ++i) {
    const auto k = static_cast<double>(i) - 3.5;
    blocks.push_back({row[i], 0.345 * k, 0, -2.05 + 0.03 * k * k, -7 * k + 4.0 * static_cast<double>(i % 3) - 4});
  }
  for (std::size_t i = 0; i < pyramid.size(); ++i) {
    const int level = i < 3 ? 0 : i < 5 ? 1 : 2, place = static_cast<int>(i) - (level == 0 ? 0 : level == 1 ? 3 : 5);
    const double along = (place - 0.5 * (2 - level)) * 0.33;
    blocks.push_back({pyramid[i], -2.3 + 0.5 * along, 0.302 * level, 0.1 - 0.86 * along, 60});
  }
  for (std::size_t i = 0; i < tower.size(); ++i) {
    const auto level = static_cast<double>(i);
    blocks.push_back({tower[i], 2.4 + 0.02 * static_cast<double>(i % 2), 0.302 * level, -0.75, -40 + 17 * level});
  }
  blocks.push_back({'A', 1.2, 0, -0.6, 25});
  blocks.push_back({'R', 1.0, 0, 1.5, -70});
  return blocks;
}

void add_blocks(Scene& scene) {
  std::map<char, int> meshes;
  int number = 0;
  for (const Block& block : block_places())
    add_instance(scene, "block " + std::to_string(++number), block_mesh(scene, meshes, block.sign),
                 shift(block.x, block.y + 0.152, block.z) * turn({0, 1, 0}, block.heading));
  const int yellow = add_plain(scene, "roof block", 0xf5c723, 0.5);
  add_object(scene, "roof block", painted(extrude({{-0.17, 0}, {0.17, 0}, {0, 0.17}}, {}, 0.3), yellow),
             shift(2.41, 1.212, -0.75) * turn({0, 1, 0}, -20));
}

/// A place on the track, `degrees` counter-clockwise from straight ahead, x along the rails.
Mat4 on_track(double degrees) {
  return turn({0, 1, 0}, degrees) * shift(0, rail_height, -track_radius);
}

void add_wheels(Scene& scene, const std::string& name, int mesh, double degrees, const std::vector<double>& places) {
  for (const double x : places)
    for (const double side : {-1.0, 1.0})
      add_instance(scene, name, mesh, on_track(degrees) * shift(x, 0.1305, side * 0.14) * turn({1, 0, 0}, side * 90));
}

void add_train(Scene& scene) {
  const int dark = add_plain(scene, "black iron", 0x2b2d33, 0.5), red = add_plain(scene, "engine red", 0xc92a2a, 0.35);
  const int green = add_plain(scene, "engine green", 0x2b7a4b, 0.35),
            gold = add_plain(scene, "gold trim", 0xe5b343, 0.3, 0.6);
  const int wood = add_textured(scene, "pine", planks(64, 2, rgb(0xd8ab73), rgb(0x96683a), 8), 0.8);
  const int rail = add_plain(scene, "rail", 0x8d949c, 0.4, 0.6), lamp = add_glowing(scene, "headlight", 0xfff2b8);
  add_object(scene, "track", track(track_radius, 0.34, 20, rail, wood));
  const int wheel_mesh = add_mesh(scene, "wheel", wheel(0.13, red));
  add_object(scene, "engine", engine({green, red, gold, dark, lamp}), on_track(30));
  add_wheels(scene, "engine wheel", wheel_mesh, 30, {-0.34, 0, 0.34});
  const std::array<std::uint32_t, 3> colors = {0x2f66c9, 0xe2a21f, 0x8a3fb0};
  for (int i = 0; i < 3; ++i) {
    const std::string name = "wagon " + std::to_string(i + 1);
    const int walls = add_plain(scene, name, colors[static_cast<std::size_t>(i)], 0.5);
    const int load =
        add_plain(scene, "load " + std::to_string(i + 1), rainbow[2 * static_cast<std::size_t>(i) + 1], 0.8);
    const double degrees = 51 + 21.0 * i;
    add_object(scene, name, wagon(dark, walls, load), on_track(degrees));
    add_wheels(scene, name + " wheel", wheel_mesh, degrees, {-0.28, 0.28});
  }
}

void add_balls(Scene& scene) {
  const Vec4 white = rgb(0xffffff);
  const std::vector<Vec4> colors = {rgb(0xd9342b), white, rgb(0xf5c723), white,
                                    rgb(0x2a6fc9), white, rgb(0x3fa648), white};
  const int beach = add_textured(scene, "beach ball", stripes(64, colors), 0.3);
  add_object(scene, "beach ball", painted(sphere(0.34, 16, 8), beach), shift(-1.4, 0.342, -0.65) * turn({1, 0, 1}, 40));
  const int rubber = add_textured(scene, "rubber ball", stripes(64, {rgb(0x2aa3c9), rgb(0xf5c723)}), 0.6);
  const int mesh = add_mesh(scene, "rubber ball", painted(sphere(0.12, 10, 6), rubber));
  const std::array<Vec2, 3> places = {Vec2(0.15, -1.35), Vec2(1.75, 0.6), Vec2(-0.8, 1.9)};
  for (const Vec2& p : places)
    add_instance(scene, "rubber ball", mesh, shift(p.x, 0.122, p.y) * turn({1, 0, 0}, 200 * p.x));
}

void add_stacking_rings(Scene& scene) {
  const Mat4 place = shift(1.75, 0.004, -1.6);
  const int wood = add_plain(scene, "beech", 0xe2bd8a, 0.6);
  add_object(scene, "stacking pole", stacking_pole(wood, add_plain(scene, "red tip", rainbow[0], 0.4)), place);
  for (int i = 0; i < 5; ++i) {
    const std::string name = "ring " + std::to_string(i + 1);
    const int material = add_plain(scene, name, rainbow[static_cast<std::size_t>(i)], 0.35);
    add_object(scene, name, painted(torus(0.3 - 0.035 * i, 0.085, 12, 5), material),
               place * shift(0, 0.15 + 0.155 * i, 0));
  }
}

void add_pins(Scene& scene) {
  const Picture bands =
      paint(8, 128, 3, [](double, double v) { return v > 0.24 && v < 0.4 ? rgb(0xcf2b2b) : rgb(0xf7f3e8); });
  const int mesh = add_mesh(scene, "pin", bowling_pin(add_textured(scene, "pin", bands, 0.3)));
  int pin = 0;
  for (int row = 0; row < 3; ++row)
    for (int i = 0; i <= row; ++i) {
      const Mat4 fallen = ++pin == 3 ? shift(0, 0.098, 0) * turn({0, 0, 1}, 84) : shift(0, 0.004, 0);
      add_instance(scene, "pin " + std::to_string(pin), mesh,
                   shift(1.5 + 0.27 * row, 0, 1.25 + 0.32 * (i - 0.5 * row)) * fallen);
    }
}

void add_shelf(Scene& scene) {
  const Mat4 place = shift(4.5, 0, 1.6) * turn({0, 1, 0}, -90);
  const int wood = add_textured(scene, "shelf wood", planks(128, 2, rgb(0xe4c79b), rgb(0xb08a57), 14), 0.7);
  add_object(scene, "bookshelf", bookshelf(1.8, 1.5, wood), place);
  double x = -0.75;
  for (int i = 0; i < 8; ++i) {
    const double thick = 0.08 + 0.02 * (i % 3), high = 0.36 + 0.04 * (i * 5 % 4), lean = i == 7 ? 12 : 0;
    const int material =
        add_plain(scene, "book " + std::to_string(i + 1), rainbow[static_cast<std::size_t>(i * 3 % 7)], 0.8);
    const double shelf = i < 5 ? 0.755 : 0.125;
    add_object(scene, "book " + std::to_string(i + 1), painted(box({thick, high, 0.28}), material),
               place * shift(x + 0.5 * thick + 0.01 * lean, shelf + 0.006 + 0.5 * high + 0.0005 * lean, 0.02) *
                   turn({0, 0, 1}, lean));
    x = i == 4 ? -0.6 : x + thick + 0.012;
  }
}

Picture house_front() {
  return paint(256, 256, 3, [](double u, double v) {
    const double x = u * 1.4 - 0.7, y = (1 - v) * 1.4;
    const double wx = std::abs(std::abs(x) - 0.4), wy = std::min(std::abs(y - 0.35), std::abs(y - 0.78));
    if (std::abs(x) < 0.14 && y < 0.46)
      return std::abs(x - 0.09) < 0.02 && std::abs(y - 0.23) < 0.02 ? rgb(0xf2d15b) : rgb(0x2a6f8f);
    if (std::abs(x) < 0.18 && y < 0.5) return rgb(0xffffff);
    const bool is_round = x * x + (y - 1.02) * (y - 1.02) < 0.012;
    if (is_round || (wx < 0.12 && wy < 0.1)) return is_round || wx < 0.012 || wy < 0.01 ? rgb(0xfff8e0) : rgb(0xffd873);
    if (wx < 0.15 && wy < 0.13) return rgb(0xffffff);
    return rgb(0xe98f9f) * (0.92 + 0.08 * std::floor(y * 18 - 2 * std::floor(y * 9)));
  });
}

Picture picket_fence() {
  return paint(64, 64, 4, [](double u, double v) {
    const double x = std::abs(u * 3 - std::floor(u * 3) - 0.5), top = 0.06 + 0.36 * x;
    Vec4 color = mix(rgb(0xffffff), rgb(0xd9d2c4), v);
    color.w = (x < 0.3 && v > top) || (v > 0.3 && v < 0.42) || (v > 0.7 && v < 0.82) ? 1 : 0;
    return color;
  });
}

void add_big_toys(Scene& scene) {
  const int pink = add_plain(scene, "pink wall", 0xe98f9f, 0.8), chimney = add_plain(scene, "chimney", 0x9a5140, 0.9);
  const int front = add_textured(scene, "house front", house_front(), 0.8);
  const int shingles = add_textured(scene, "shingles", bricks(128, rgb(0x8f3b34), rgb(0x5c211d)), 0.8);
  const int fence = add_cutout(scene, "fence", picket_fence(), 0.7);
  add_object(scene, "doll's house", dolls_house(front, pink, shingles, chimney, fence),
             shift(2.6, 0, -3.75) * turn({0, 1, 0}, -20));
  const int white = add_plain(scene, "rocket white", 0xf2f2f5, 0.3),
            red = add_plain(scene, "rocket red", 0xd0342c, 0.35);
  add_object(scene, "rocket", rocket(white, red, add_plain(scene, "glass", 0x6fc3e8, 0.1)),
             shift(-3.9, 0, -3.9) * turn({0, 1, 0}, 45));
  const int tin = add_plain(scene, "tin", 0x9db4c4, 0.35, 0.6), joint = add_plain(scene, "grey joint", 0x4d545c, 0.5);
  add_object(scene, "robot", robot(tin, joint, add_glowing(scene, "robot eye", 0xff8a2b)),
             shift(4.1, 0, -0.1) * turn({0, 1, 0}, -85));
  const int fur = add_textured(scene, "fur", speckled(64, rgb(0xb9803f), rgb(0x8a5a26), 16, 15), 1);
  const TeddyColors colors{fur, add_plain(scene, "snout", 0xe6c796, 1), add_plain(scene, "button", 0x16130f, 0.2)};
  add_object(scene, "teddy", teddy(colors), shift(-1.7, 0.004, 0.9) * turn({0, 1, 0}, 100));
}

void add_music(Scene& scene) {
  const int frame = add_plain(scene, "xylophone frame", 0xd9b37a, 0.7),
            red = add_plain(scene, "mallet red", 0xd0342c, 0.5);
  const Mat4 place = shift(-0.25, 0, -0.95) * turn({0, 1, 0}, 14);
  add_object(scene, "xylophone", xylophone_frame(7, frame), place);
  for (int i = 0; i < 7; ++i) {
    const std::string name = "bar " + std::to_string(i + 1);
    const int material = add_plain(scene, name, rainbow[static_cast<std::size_t>(i)], 0.25, 0.4);
    add_object(scene, name, painted(box({0.12, 0.03, bar_length(i)}), material), place * bar_place(i, 7));
  }
  add_object(scene, "mallet", mallet(frame, red), place * pointing({0.5, 0.05, 0.45}, {0.1, 0.16, 0.1}));
  const int blue = add_textured(scene, "drum shell", checker(64, 8, rgb(0x2b5fb8), rgb(0xf0c63c)), 0.5);
  add_object(scene, "drum", drum(blue, add_plain(scene, "drum skin", 0xf3ead6, 0.8), red), shift(-3.8, 0, 2.9));
  const int swirl =
      add_textured(scene, "top", stripes(64, {rgb(0x8a3fb0), rgb(0xf5c723), rgb(0x2aa3c9), rgb(0xf5c723)}), 0.3);
  add_object(scene, "spinning top", spinning_top(swirl, add_plain(scene, "chrome", 0xc9ced4, 0.2, 0.8)),
             shift(0.75, 0.02, -0.2) * turn({0, 0, 1}, -14));
}

void add_kite(Scene& scene) {
  Material cloth;
  cloth.name = "kite cloth";
  cloth.metallic = 0;
  cloth.roughness = 0.9;
  cloth.double_sided = true;
  const auto color = [](const Vec3& p) {
    return p.y < -0.85 ? Vec3(0.9, 0.15, 0.1) : Vec3(0.5 + 0.5 * p.x, 0.35 + 0.4 * p.y, 0.55 - 0.6 * p.x);
  };
  const auto clamped = [color](const Vec3& p) { return glm::clamp(color(p), 0.0, 1.0); };
  add_object(scene, "kite", kite(add_material(scene, cloth)),
             shift(-1.2, 3.2, -2.8) * turn({0, 1, 0}, 20) * turn({0, 0, 1}, -25) * turn({1, 0, 0}, 25), clamped);
}

} // namespace

Scene make_toys() {
  Scene scene;
  add_object(scene, "nursery", nursery(scene));
  add_blocks(scene);
  add_train(scene);
  add_balls(scene);
  add_stacking_rings(scene);
  add_pins(scene);
  add_shelf(scene);
  add_big_toys(scene);
  add_music(scene);
  add_kite(scene);
  add_camera(scene, "child", {0, 0.95, 0.35}, {0, 0.55, -2.5}, 75);
  add_camera(scene, "door", {2.6, 2.1, 4.2}, {-0.3, 0.4, -0.8}, 60);
  add_point_light(scene, "ceiling lamp", {0.3, 2.2, -0.6}, 0xfff0d8, 13);
  add_point_light(scene, "bedside lamp", {-3.2, 1.8, 2.8}, 0xffd9a0, 8);
  add_point_light(scene, "standing lamp", {1.2, 2.2, 2.8}, 0xfff0d8, 9);
  add_point_light(scene, "night light", {3.4, 1.6, -2.6}, 0xdfe6ff, 7);
  return scene;
}

} // namespace domewarp::test_scenes
