// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "domewarp/scene/test_scenes/outline.h"
#include "domewarp/scene/test_scenes/scenes.h"
#include "domewarp/scene/test_scenes/solids.h"
#include "domewarp/scene/test_scenes/stage.h"

/// A workbench twenty times too large: the viewer stands among the tools.
namespace domewarp::test_scenes {

namespace {

struct Metals {
  int steel, dark_steel, brass, zinc, copper;
};

Picture brushed(const Vec4& light, const Vec4& dark, std::uint32_t seed) {
  return paint(128, 128, 3, [&](double u, double v) {
    return mix(light, dark, 0.6 * noise(u * 64, v * 2, 64, seed) + 0.3 * clouds(u, v, 4, seed));
  });
}

Metals add_metals(Scene& scene) {
  return {add_textured(scene, "brushed steel", brushed(rgb(0xd5dadf), rgb(0x7f8890), 2), 0.35, 0.7),
          add_plain(scene, "blackened steel", 0x4a4d55, 0.45, 0.6), add_plain(scene, "brass", 0xd9ab4f, 0.3, 0.8),
          add_plain(scene, "zinc", 0xb8c0c8, 0.4, 0.6), add_plain(scene, "copper", 0xc9774c, 0.35, 0.8)};
}

Picture yard() {
  return paint(256, 256, 3, [](double u, double v) {
    const double roof = 0.62 - 0.18 * std::abs(u * 2 - std::floor(u * 2) - 0.5);
    if (v > 0.8) return mix(rgb(0x7c8a6a), rgb(0x56624a), clouds(u, v, 16, 4));
    if (v > roof)
      return v < roof + 0.06 ? rgb(0x8d4a3a) : mix(rgb(0xd8c7a6), rgb(0xb39f7c), noise(u * 12, v * 12, 12, 2));
    return mix(mix(rgb(0x78b4ea), rgb(0xe8f3fb), v / 0.6), rgb(0xffffff), ramp(0.5, 0.75, clouds(u, v, 4, 31)));
  });
}

Picture hazard() {
  return paint(64, 64, 3, [](double u, double v) {
    const double x = 2 * (u + v);
    return x - std::floor(x) < 0.5 ? rgb(0xf0bf1a) : rgb(0x202020);
  });
}

/// Large walls, two windows, a door and a warning sign, seen from the height of the bench.
Shape workshop(Scene& scene) {
  const int floor = add_textured(scene, "concrete", speckled(128, rgb(0x8b8b86), rgb(0x5f605e), 8, 12), 0.95);
  const int wall = add_textured(scene, "bricks", bricks(256, rgb(0xb8654b), rgb(0xcabfb0)), 0.95);
  const int ceiling = add_textured(scene, "boards", planks(256, 8, rgb(0xd6b98a), rgb(0x93704a), 5), 0.8);
  const int paint = add_plain(scene, "green paint", 0x3f6b58, 0.5);
  const int sky = add_unlit(scene, "yard", yard());
  Shape shape = remapped(room(rectangle(34, 28), 19, floor, wall, ceiling), Vec2(0), Vec2(1.0 / 5));
  for (const double side : {-1.0, 1.0}) {
    const Mat4 at = shift(side * 17, 13, -5) * turn({0, 1, 0}, -90 * side);
    append(shape, moved(painted(extrude(rectangle(11, 8), {rectangle(9.6, 6.6)}, 0.6), paint), at));
    append(shape, moved(painted(panel(9.9, 6.9), sky), at * shift(0, 0, 0.05)));
  }
  append(shape, moved(painted(box({0.5, 13, 7}), paint), shift(16.9, 6.52, 7)));
  const int sign = add_textured(scene, "hazard", hazard(), 0.6);
  append(shape, moved(painted(panel(4, 2), sign), shift(7, 14.5, 13.95) * turn({0, 1, 0}, 180)));
  return moved(shape, shift(0, -9, 0));
}

Shape bench(Scene& scene) {
  const int wood = add_textured(scene, "beech", planks(256, 4, rgb(0xd9a86c), rgb(0x94622f), 9), 0.6);
  Shape shape = moved(with_box_uvs(bevelled_box({17, 0.8, 11}, 0.08), Vec3(4)), shift(0, -0.4, 0));
  for (const double x : {-7.4, 7.4})
    for (const double z : {-4.4, 4.4})
      append(shape, moved(with_box_uvs(box({0.9, 8.5, 0.9}), Vec3(4)), shift(x, -4.73, z)));
  return painted(shape, wood);
}

Picture pegboard_picture() {
  return paint(128, 128, 4, [](double u, double v) {
    const double x = u * 4 - std::floor(u * 4) - 0.5, y = v * 4 - std::floor(v * 4) - 0.5;
    Vec4 color = mix(rgb(0xc79a66), rgb(0xa87a48), clouds(u, v, 16, 13));
    color.w = x * x + y * y < 0.03 ? 0 : 1;
    return color;
  });
}

Shape pegboard(Scene& scene) {
  const int board = add_cutout(scene, "pegboard", pegboard_picture(), 0.9);
  return painted(remapped(panel(12, 6), Vec2(0), Vec2(6, 3)), board);
}

/// Stands on its head, which is 0.35 high; 2.1 long.
Shape bolt(int material) {
  Shape shape = lathe({{0, 0}, {0.47, 0}, {0.55, 0.06}, {0.55, 0.35}, {0, 0.35}}, 6);
  append(shape, moved(cylinder(0.29, 0.65, 12), shift(0, 0.3, 0)));
  append(shape, moved(screw_thread(0.23, 0.3, 0.13, 7, 12), shift(0, 0.9, 0)));
  return painted(shape, material);
}

Shape nut(int material) {
  const Shape shape = extrude(regular_polygon(0.55, 6), {regular_polygon(0.29, 16)}, 0.45);
  return painted(moved(shape, turn({1, 0, 0}, -90)), material);
}

Shape washer(double inner, double outer, int material) {
  return painted(lathe({{inner, 0}, {outer, 0}, {outer, 0.08}, {inner, 0.08}, {inner, 0}}, 18), material);
}

struct Gear {
  int teeth, holes, hole_sides;
  double bore;
};

constexpr double module = 0.16; ///< pitch diameter per tooth

double pitch_radius(const Gear& gear) {
  return 0.5 * module * gear.teeth;
}

Shape gear_shape(const Gear& gear, int material) {
  const double r = pitch_radius(gear);
  std::vector<Outline> holes = {regular_polygon(gear.bore, 12)};
  const double reach = 0.5 * (r - 0.2 + gear.bore), hole = 0.3 * (r - 0.2 - gear.bore);
  for (int i = 0; i < gear.holes; ++i)
    holes.push_back(shifted(regular_polygon(hole, gear.hole_sides), reach * circle((i + 0.5) / gear.holes)));
  return painted(extrude(gear_outline(r - 0.17, r + 0.14, gear.teeth), holes, 0.35), material);
}

/// A gear on its peg, in front of the pegboard. @param phase of the first tooth, in turns
void add_gear(Scene& scene, const std::string& name, const Gear& gear, const Vec2& at, double phase, int material,
              int peg) {
  Shape shape = moved(gear_shape(gear, material), turn({0, 0, 1}, 360 * phase));
  const Shape pin =
      lathe({{0, 0}, {0.8 * gear.bore, 0}, {0.8 * gear.bore, 0.78}, {1.4 * gear.bore, 0.88}, {0, 0.94}}, 10);
  append(shape, moved(painted(pin, peg), turn({1, 0, 0}, 90) * shift(0, -0.53, 0)));
  add_object(scene, name, shape, shift(at.x, at.y, -4.1));
}

/// Three gears in mesh: where two meet, a tooth of one points into a gap of the other.
void add_gears(Scene& scene, const Metals& metals) {
  const Gear large{18, 5, 8, 0.2}, middle{12, 3, 6, 0.17}, small{8, 0, 0, 0.14};
  const Vec2 first(-1.1, 2.6);
  const double to_middle = 1.0 / 18, to_small = 0.0;
  const Vec2 second = first + (pitch_radius(large) + pitch_radius(middle)) * circle(to_middle);
  const Vec2 third = second + (pitch_radius(middle) + pitch_radius(small)) * circle(to_small);
  const double second_phase = to_middle + 0.5 - 0.5 / middle.teeth;
  const double met = (to_small - second_phase) * middle.teeth;
  add_gear(scene, "large gear", large, first, 0, metals.brass, metals.dark_steel);
  add_gear(scene, "middle gear", middle, second, second_phase, metals.steel, metals.dark_steel);
  add_gear(scene, "small gear", small, third, to_small + 0.5 - (0.5 - (met - std::floor(met))) / small.teeth,
           metals.copper, metals.dark_steel);
}

/// Ring at the left end, jaw at the right, 5 long, in the xy plane.
Shape spanner(int material) {
  Outline outline = arc({-2.2, 0}, 0.62, 0.06, 0.94, 11);
  const Outline jaw = {{1.45, -0.3}, {1.75, -0.62}, {2.25, -0.82}, {2.85, -0.66}, {2.9, -0.42},
                       {2.2, -0.4},  {1.98, -0.2},  {1.98, 0.2},   {2.2, 0.4},    {2.9, 0.42},
                       {2.85, 0.66}, {2.25, 0.82},  {1.75, 0.62},  {1.45, 0.3}};
  outline.insert(outline.end(), jaw.begin(), jaw.end());
  return painted(extrude(outline, {shifted(regular_polygon(0.36, 12), {-2.2, 0})}, 0.3), material);
}

Shape screwdriver(const Metals& metals, int grip, int band) {
  Shape shape = painted(
      lathe({{0, 0}, {0.2, 0.02}, {0.34, 0.15}, {0.36, 0.9}, {0.3, 1.35}, {0.33, 1.6}, {0.2, 1.75}, {0, 1.75}}, 10),
      grip);
  append(shape, painted(moved(lathe({{0, 0}, {0.22, 0}, {0.2, 0.2}, {0, 0.2}}, 10), shift(0, 1.7, 0)), band));
  append(shape, painted(moved(lathe({{0, 0}, {0.1, 0}, {0.1, 2}, {0, 2}}, 8), shift(0, 1.8, 0)), metals.steel));
  const Shape blade =
      extrude({{-0.09, 0}, {0.09, 0}, {0.17, 0.25}, {0.13, 0.6}, {-0.13, 0.6}, {-0.17, 0.25}}, {}, 0.07);
  append(shape, painted(moved(blade, shift(0, 3.7, 0)), metals.steel));
  return shape;
}

/// The handle runs along y, the head across along x.
Shape hammer(const Metals& metals, int handle) {
  Shape shape =
      painted(lathe({{0, 0}, {0.2, 0.02}, {0.26, 0.2}, {0.24, 1.4}, {0.16, 2.4}, {0.18, 4.3}, {0, 4.32}}, 10), handle);
  Shape head = moved(bevelled_box({0.8, 0.7, 0.7}, 0.1), shift(0, 3.9, 0));
  append(head, moved(lathe({{0, 0}, {0.24, 0}, {0.24, 0.35}, {0.36, 0.5}, {0.36, 0.9}, {0.3, 0.96}, {0, 0.96}}, 12),
                     shift(0.3, 3.9, 0) * turn({0, 0, 1}, -90)));
  const Outline claw = {{-0.3, -0.28},  {-0.3, 0.28},  {-0.8, 0.2},  {-1.2, 0},
                        {-1.55, -0.35}, {-1.1, -0.22}, {-0.7, -0.18}};
  append(head, moved(extrude(claw, {}, 0.5), shift(0, 3.9, 0)));
  append(shape, painted(head, metals.dark_steel));
  return shape;
}

Shape spring(int material) {
  std::vector<Vec3> path;
  for (int i = 0; i <= 37; ++i) {
    const Vec2 c = circle(i / 12.0);
    path.emplace_back(0.5 * c.x, 0.08 + i * 0.034, -0.5 * c.y);
  }
  return painted(tube(path, std::vector<double>(path.size(), 0.07), 6), material);
}

Shape desk_lamp(Scene& scene, const Metals& metals) {
  Material enamel;
  enamel.name = "red enamel";
  enamel.base_color = Vec4(linear(0xb3261e), 1);
  enamel.metallic = 0;
  enamel.roughness = 0.35;
  enamel.double_sided = true;
  const int red = add_material(scene, enamel);
  Shape lamp = painted(lathe({{0, 0}, {0.9, 0}, {0.9, 0.15}, {0.25, 0.3}, {0, 0.3}}, 12), red);
  append(lamp, painted(tube({{0, 0.25, 0}, {0.35, 2.6, 0.1}, {-0.6, 4.3, 0.2}}, {0.07, 0.07, 0.07}, 6), metals.zinc));
  Shape shade = painted(lathe({{0.85, -1}, {0.6, -0.35}, {0.22, 0}, {0.2, 0.25}}, 12), red);
  append(shade, moved(painted(sphere(0.28, 8, 4), add_glowing(scene, "bulb", 0xfff3d0)), shift(0, -0.42, 0)));
  append(lamp, moved(shade, shift(-0.65, 4.3, 0.2) * turn({0, 0, 1}, -25)));
  return lamp;
}

void add_small_parts(Scene& scene, const Metals& metals) {
  const int bolt_mesh = add_mesh(scene, "bolt", bolt(metals.zinc));
  add_instance(scene, "standing bolt", bolt_mesh, shift(1.9, 0.004, -1.6) * turn({0, 1, 0}, 20));
  add_instance(scene, "lying bolt", bolt_mesh, pointing({-1.35, 0.482, 0.5}, {0.3, 0.385, -0.9}) * turn({0, 1, 0}, 30));
  add_instance(scene, "far bolt", bolt_mesh, pointing({4.2, 0.482, 2.6}, {5.4, 0.385, 4.3}) * turn({0, 1, 0}, 30));
  const int nut_mesh = add_mesh(scene, "nut", nut(metals.brass));
  add_instance(scene, "nut", nut_mesh, shift(0.9, 0.23, 0.4) * turn({0, 1, 0}, 12));
  add_instance(scene, "nut on a bolt", nut_mesh, shift(1.9, 1.45, -1.6) * turn({0, 1, 0}, 47));
  add_instance(scene, "upright nut", nut_mesh, shift(-2.9, 0.4783, -1.2) * turn({0, 1, 0}, 35) * turn({1, 0, 0}, 90));
  add_instance(scene, "nut behind", nut_mesh, shift(-0.9, 0.23, 4.1) * turn({0, 1, 0}, 70));
  const int washer_mesh = add_mesh(scene, "washer", washer(0.33, 0.75, metals.zinc));
  add_instance(scene, "washer", washer_mesh, shift(2.6, 0.004, 0.6));
  add_instance(scene, "leaning washer", washer_mesh, shift(2.9, 0.06, 0.35) * turn({0, 1, 0}, 25) * turn({0, 0, 1}, 8));
}

void add_tools(Scene& scene, const Metals& metals) {
  const int grip = add_plain(scene, "amber grip", 0xe07b1a, 0.25);
  const int handle = add_textured(scene, "ash wood", planks(128, 1, rgb(0xe6c48e), rgb(0xb48a55), 21), 0.6);
  add_object(scene, "spanner", spanner(metals.steel),
             shift(-3.4, 0.16, -2.4) * turn({0, 1, 0}, 28) * turn({1, 0, 0}, -90));
  add_object(scene, "screwdriver", screwdriver(metals, grip, metals.dark_steel),
             pointing({4.6, 0.365, 0.9}, {2.9, 0.08, -2.9}));
  add_object(scene, "hammer", hammer(metals, handle),
             shift(-4.8, 0.39, 4.6) * turn({0, 1, 0}, -12) * turn({1, 0, 0}, -90));
  add_object(scene, "spring", spring(metals.dark_steel), shift(-0.6, 0.004, -2.2));
  add_object(scene, "desk lamp", desk_lamp(scene, metals), shift(5.6, 0.004, -2.6));
}

} // namespace

Scene make_hardware() {
  Scene scene;
  const Metals metals = add_metals(scene);
  add_object(scene, "workshop", workshop(scene));
  add_object(scene, "bench", bench(scene));
  add_object(scene, "pegboard", pegboard(scene), shift(0, 3.01, -4.6));
  add_gears(scene, metals);
  add_small_parts(scene, metals);
  add_tools(scene, metals);
  add_camera(scene, "on the bench", {0.1, 1.5, 2.6}, {0.1, 1.2, -2.5}, 70);
  add_camera(scene, "visitor", {-5.5, 4.5, 7.5}, {0.3, 0.8, -1.5}, 55);
  add_spot(scene, "desk lamp", {4.6, 3.6, -2.4}, {0.5, 0, -1}, 0xfff0cc, 25);
  add_point_light(scene, "window light", {-6, 5, 1.5}, 0xe6f0ff, 90);
  add_point_light(scene, "ceiling light", {5, 5.5, 6}, 0xfff4e0, 90);
  return scene;
}

} // namespace domewarp::test_scenes
