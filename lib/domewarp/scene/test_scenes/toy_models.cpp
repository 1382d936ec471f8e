// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/test_scenes/toy_models.h"

#include <utility>

#include "domewarp/scene/test_scenes/outline.h"
#include "domewarp/scene/test_scenes/solids.h"

namespace domewarp::test_scenes {

namespace {

Shape box_at(const Vec3& size, const Vec3& middle, int material) {
  return painted(moved(box(size), shift(middle.x, middle.y, middle.z)), material);
}

Shape ball_at(double radius, const Vec3& middle, int sides, int rings, int material) {
  return painted(moved(sphere(radius, sides, rings), shift(middle.x, middle.y, middle.z)), material);
}

} // namespace

Shape engine(const EngineColors& colors) {
  Shape shape = box_at({1.0, 0.1, 0.36}, {0, 0.2, 0}, colors.dark);
  append(shape, painted(moved(cylinder(0.16, 0.62, 12), shift(-0.16, 0.4, 0) * turn({0, 0, 1}, -90)), colors.boiler));
  append(shape, painted(moved(cylinder(0.17, 0.1, 12), shift(0.42, 0.4, 0) * turn({0, 0, 1}, -90)), colors.dark));
  append(shape, box_at({0.32, 0.5, 0.4}, {-0.3, 0.48, 0}, colors.cab));
  append(shape, box_at({0.42, 0.05, 0.5}, {-0.3, 0.745, 0}, colors.trim));
  const Shape chimney = lathe({{0, 0}, {0.05, 0}, {0.05, 0.12}, {0.09, 0.26}, {0.06, 0.26}, {0, 0.18}}, 8);
  append(shape, painted(moved(chimney, shift(0.3, 0.53, 0)), colors.dark));
  append(shape, ball_at(0.08, {0.07, 0.55, 0}, 8, 4, colors.trim));
  append(shape, box_at({0.06, 0.13, 0.44}, {0.52, 0.2, 0}, colors.trim));
  append(shape, ball_at(0.05, {0.52, 0.43, 0}, 6, 4, colors.lamp));
  return shape;
}

Shape wagon(int chassis, int walls, int load) {
  Shape shape = box_at({0.9, 0.08, 0.34}, {0, 0.2, 0}, chassis);
  const Shape hopper = extrude(rectangle(0.84, 0.4), {rectangle(0.76, 0.32)}, 0.24);
  append(shape, painted(moved(hopper, shift(0, 0.35, 0) * turn({1, 0, 0}, -90)), walls));
  append(shape, box_at({0.2, 0.04, 0.06}, {0.54, 0.2, 0}, chassis));
  for (const double x : {-0.24, 0.0, 0.24}) append(shape, ball_at(0.13, {x + 0.01, 0.375, 0.008}, 6, 4, load));
  return shape;
}

Shape wheel(double radius, int material) {
  return painted(lathe({{0, 0}, {radius, 0}, {radius, 0.06}, {0, 0.03}}, 10), material);
}

Shape track(double radius, double gauge, int sleepers, int rail, int wood) {
  Shape shape;
  for (const double r : {radius - 0.5 * gauge, radius + 0.5 * gauge}) {
    std::vector<Vec3> path;
    for (const Vec2& p : regular_polygon(r, 28)) path.emplace_back(p.x, 0.05, -p.y);
    append(shape, painted(loop_tube(path, 0.03, 3), rail));
  }
  for (int i = 0; i < sleepers; ++i)
    append(shape, moved(box_at({0.09, 0.03, 0.5}, {0, 0.019, -radius}, wood), turn({0, 1, 0}, 360.0 * i / sleepers)));
  return shape;
}

Shape bowling_pin(int material) {
  return painted(lathe({{0, 0}, {0.05, 0}, {0.1, 0.16}, {0.045, 0.36}, {0.06, 0.44}, {0.035, 0.5}, {0, 0.52}}, 8),
                 material);
}

Shape stacking_pole(int wood, int tip) {
  Shape shape = painted(lathe({{0, 0}, {0.4, 0}, {0.4, 0.06}, {0, 0.06}}, 14), wood);
  append(shape, painted(moved(lathe({{0, 0}, {0.07, 0}, {0.05, 0.88}, {0, 0.88}}, 8), shift(0, 0.05, 0)), wood));
  append(shape, ball_at(0.11, {0, 0.97, 0}, 8, 5, tip));
  return shape;
}

Shape bookshelf(double width, double height, int material) {
  Shape shape;
  for (const double side : {-0.5, 0.5})
    append(shape, box_at({0.06, height, 0.4}, {side * width, 0.5 * height + 0.004, 0}, material));
  for (int i = 0; i < 3; ++i) append(shape, box_at({width, 0.05, 0.38}, {0, 0.1 + 0.42 * height * i, 0}, material));
  append(shape, box_at({width - 0.02, height - 0.1, 0.03}, {0, 0.5 * height, -0.18}, material));
  return shape;
}

Shape dolls_house(int front, int wall, int roof, int chimney, int fence) {
  const Outline gable = {{-0.7, 0}, {0.7, 0}, {0.7, 0.9}, {0, 1.45}, {-0.7, 0.9}};
  Shape body = extrude(gable, {}, 1, wall, wall);
  body = painted_towards(body, {0, 0, 1}, 0.9, front);
  Shape shape = remapped(moved(body, shift(0, 0.004, 0)), Vec2(0.5, 1), Vec2(1 / 1.4), front);
  for (const double side : {-1.0, 1.0})
    append(shape, painted(moved(with_box_uvs(box({0.98, 0.06, 1.2 + 0.02 * side}), Vec3(0.5)),
                                shift(side * 0.4, 1.2, 0) * turn({0, 0, 1}, side * -38.1572)),
                          roof));
  append(shape, box_at({0.16, 0.5, 0.16}, {0.42, 1.42, -0.2}, chimney));
  append(shape, box_at({0.34, 0.05, 0.2}, {0, 0.031, 0.58}, wall));
  const Shape pickets = painted(remapped(panel(1.6, 0.34), Vec2(0), Vec2(1.6 / 0.34, 1)), fence);
  append(shape, moved(pickets, shift(-1.55, 0.175, 0.85)));
  append(shape, moved(pickets, shift(1.55, 0.175, 0.85)));
  append(shape, moved(pickets, shift(-2.37, 0.175, 0.04) * turn({0, 1, 0}, 90)));
  return shape;
}

double bar_length(int bar) {
  return 0.62 - 0.05 * bar;
}

Mat4 bar_place(int bar, int bars) {
  return shift((bar - 0.5 * (bars - 1)) * 0.15, 0.125, 0);
}

Shape xylophone_frame(int bars, int material) {
  Shape shape;
  const double length = 0.15 * bars + 0.1;
  for (const double side : {-1.0, 1.0})
    append(shape, moved(box_at({length, 0.1, 0.05}, {0, 0.054, 0}, material),
                        shift(0, 0, side * 0.14) * turn({0, 1, 0}, side * 4)));
  return shape;
}

Shape mallet(int stick, int head) {
  Shape shape = painted(cylinder(0.012, 0.6, 6), stick);
  append(shape, ball_at(0.05, {0, 0.6, 0}, 6, 4, head));
  return shape;
}

Shape drum(int shell, int skin, int rim) {
  Shape shape = painted(lathe({{0, 0.02}, {0.38, 0.02}, {0.38, 0.5}, {0, 0.5}}, 12), shell);
  shape = painted_towards(shape, {0, 1, 0}, 0.9, skin);
  for (const double y : {0.034, 0.49}) append(shape, painted(moved(torus(0.385, 0.03, 12, 4), shift(0, y, 0)), rim));
  return shape;
}

Shape spinning_top(int material, int metal) {
  Shape shape = painted(
      lathe({{0, 0}, {0.05, 0.06}, {0.26, 0.25}, {0.28, 0.3}, {0.2, 0.38}, {0.04, 0.42}, {0, 0.42}}, 12), material);
  append(shape, painted(moved(cylinder(0.022, 0.26, 6), shift(0, 0.4, 0)), metal));
  append(shape, ball_at(0.05, {0, 0.68, 0}, 6, 4, metal));
  return shape;
}

Shape rocket(int body, int fin, int glass) {
  Shape shape = painted(
      lathe({{0, 0.25}, {0.16, 0.25}, {0.24, 0.6}, {0.24, 1.0}, {0.14, 1.4}, {0.05, 1.62}, {0, 1.66}}, 10), body);
  append(shape, painted(lathe({{0, 0.12}, {0.16, 0.12}, {0.08, 0.3}, {0, 0.3}}, 8), glass));
  const Outline outline = {{0.05, 0.3}, {0.4, 0.004}, {0.46, 0.004}, {0.42, 0.4}, {0.05, 0.75}};
  for (int i = 0; i < 3; ++i)
    append(shape, painted(moved(extrude(outline, {}, 0.05), turn({0, 1, 0}, 120.0 * i + 30)), fin));
  append(shape, painted(moved(torus(0.1, 0.03, 8, 4), shift(0, 0.95, 0.235) * turn({1, 0, 0}, 90)), fin));
  append(shape, ball_at(0.09, {0, 0.95, 0.2}, 8, 4, glass));
  return shape;
}

Shape robot(int body, int joint, int eye) {
  Shape shape = painted(moved(bevelled_box({0.5, 0.55, 0.36}, 0.04), shift(0, 0.65, 0)), body);
  append(shape, painted(moved(bevelled_box({0.36, 0.3, 0.3}, 0.04), shift(0, 1.13, 0)), body));
  append(shape, painted(moved(cylinder(0.08, 0.16, 8), shift(0, 0.88, 0)), joint));
  for (const double side : {-1.0, 1.0}) {
    append(shape, box_at({0.16, 0.42, 0.18}, {side * 0.14, 0.26, 0}, joint));
    append(shape, box_at({0.2, 0.08, 0.34}, {side * 0.14, 0.045, 0.04}, body));
    append(shape, moved(box_at({0.11, 0.46, 0.12}, {0, -0.2, 0}, joint),
                        shift(side * 0.31, 0.84, 0) * turn({1, 0, 0}, side * 35 - 20)));
    append(shape, ball_at(0.05, {side * 0.09, 1.17, 0.14}, 6, 3, eye));
  }
  append(shape, painted(moved(cylinder(0.012, 0.2, 4), shift(0, 1.26, 0)), joint));
  append(shape, ball_at(0.035, {0, 1.48, 0}, 5, 3, eye));
  return shape;
}

Shape teddy(const TeddyColors& colors) {
  Shape shape = painted(moved(sphere(0.3, 10, 6), shift(0, 0.33, 0) * stretch(1, 1.1, 0.9)), colors.fur);
  append(shape, ball_at(0.23, {0, 0.82, 0.02}, 10, 6, colors.fur));
  append(shape, painted(moved(sphere(0.1, 8, 4), shift(0, 0.77, 0.21) * stretch(1, 0.8, 0.8)), colors.snout));
  append(shape, ball_at(0.035, {0, 0.81, 0.29}, 6, 3, colors.black));
  for (const double side : {-1.0, 1.0}) {
    append(shape, ball_at(0.085, {side * 0.17, 1.0, 0}, 6, 4, colors.fur));
    append(shape, ball_at(0.028, {side * 0.085, 0.88, 0.215}, 5, 3, colors.black));
    append(shape, painted(moved(sphere(0.1, 8, 5),
                                shift(side * 0.32, 0.5, 0.1) * turn({0, 0, 1}, side * 40) * stretch(0.9, 2.1, 0.9)),
                          colors.fur));
    append(shape, painted(moved(sphere(0.12, 8, 5),
                                shift(side * 0.2, 0.13, 0.3) * turn({0, 1, 0}, side * 20) * stretch(0.9, 0.95, 2)),
                          colors.fur));
  }
  return shape;
}

Shape kite(int cloth) {
  const Vec3 top(0, 0.6, 0), bottom(0, -0.9, 0), left(-0.5, 0.1, -0.1), right(0.5, 0.1, -0.1), middle(0, 0.1, 0.06);
  Shape shape;
  const Vec2 uv(0);
  for (const auto& [a, b] : {std::pair{top, left}, {left, bottom}, {bottom, right}, {right, top}})
    shape.push_back({{on_grid(a), on_grid(b), on_grid(middle)}, {uv, uv, uv}});
  std::vector<Vec3> tail;
  for (int i = 0; i <= 12; ++i)
    tail.push_back(bottom + Vec3(0.16 * circle(i / 6.0).y, -0.09 * i, 0.05 * circle(i / 9.0).x));
  append(shape, tube(tail, std::vector<double>(tail.size(), 0.016), 3));
  return painted(shape, cloth);
}

} // namespace domewarp::test_scenes
