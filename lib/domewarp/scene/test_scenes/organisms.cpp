// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/test_scenes/organisms.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/scene/test_scenes/outline.h"
#include "domewarp/scene/test_scenes/pictures.h"
#include "domewarp/scene/test_scenes/solids.h"

namespace domewarp::test_scenes {

namespace {

/// A point at `distance` from the axis of the DNA, `along` in 0..1 from foot to foot, turned by `phase` turns.
struct Helix {
  double arch_radius, radius, turns;

  Vec3 at(double along, double phase, double distance) const {
    const Vec2 way = circle(0.5 * along), around = circle(turns * along + phase);
    const double reach = arch_radius + distance * around.x;
    return {reach * way.x, reach * way.y, distance * around.y};
  }
};

Shape rung(const Vec3& a, const Vec3& b, int first, int second) {
  const double radius = 0.055;
  Shape shape = painted(tube({a, a + 0.47 * (b - a)}, {radius, radius}, 4), first);
  append(shape, painted(tube({b, b + 0.47 * (a - b)}, {radius, radius}, 4), second));
  return shape;
}

} // namespace

Shape dna_arch(double arch_radius, const DnaColors& colors) {
  const Helix helix{arch_radius, 0.6, 9};
  const int pieces = 108, rungs = 48;
  const std::array<double, 2> phases = {0, 0.42};
  Shape shape;
  for (std::size_t strand = 0; strand < 2; ++strand) {
    std::vector<Vec3> path;
    for (int i = 0; i <= pieces; ++i)
      path.push_back(helix.at(static_cast<double>(i) / pieces, phases[strand], helix.radius));
    append(shape, painted(tube(path, std::vector<double>(path.size(), 0.11), 6), colors.strands[strand]));
  }
  for (int i = 0; i < rungs; ++i) {
    const double along = (i + 0.5) / rungs;
    const int pair = static_cast<int>(4 * random_at(i, 0, 41));
    const auto base = static_cast<std::size_t>(pair), partner = static_cast<std::size_t>(pair ^ 1);
    append(shape, rung(helix.at(along, phases[0], helix.radius), helix.at(along, phases[1], helix.radius),
                       colors.bases[base], colors.bases[partner]));
  }
  return shape;
}

Shape bowl(double radius, double thickness, int sides, int rings, int outer, int inner) {
  std::vector<Vec2> profile;
  for (int i = 0; i <= rings; ++i) profile.push_back(radius * circle(0.25 * i / rings - 0.25));
  for (int i = rings; i >= 0; --i) profile.push_back((radius - thickness) * circle(0.25 * i / rings - 0.25));
  Shape shape = painted(lathe(profile, sides), outer);
  for (Face& face : shape) {
    const Vec3 middle = (face.points[0] + face.points[1] + face.points[2]) / 3.0;
    if (glm::dot(area_normal(face), middle) < 0) face.material = inner;
  }
  return shape;
}

Shape animal_cell(double radius, const CellColors& colors) {
  Shape shape = bowl(radius, 0.07 * radius, 24, 7, colors.membrane, colors.cytoplasm);
  append(shape, painted(moved(sphere(0.42 * radius, 16, 9), shift(-0.2 * radius, -0.3 * radius, 0.1 * radius)),
                        colors.nucleus));
  append(shape, painted(moved(sphere(0.15 * radius, 8, 5), shift(-0.28 * radius, 0.03 * radius, 0.12 * radius)),
                        colors.nucleolus));
  for (int i = 0; i < 4; ++i) {
    const Shape disc = moved(torus(0.2 * radius, 0.055 * radius, 10, 5), stretch(1, 0.9, 0.5));
    append(shape, painted(moved(disc, shift(0.45 * radius, (-0.28 + 0.125 * i) * radius, -0.3 * radius) *
                                          turn({0, 1, 0}, 30.0 + 8 * i)),
                          colors.golgi));
  }
  for (int i = 0; i < 9; ++i) {
    const Vec2 c = circle(0.02 + 0.093 * i) * (0.62 + 0.12 * (i % 2)) * radius;
    const double size = (0.06 + 0.03 * random_at(i, 1, 5)) * radius;
    append(shape,
           painted(moved(sphere(size, 8, 5), shift(c.x, (-0.16 + 0.09 * (i % 3)) * radius, c.y)), colors.vesicle));
  }
  return shape;
}

namespace {

/// A folded band in the xy plane that fills an ellipse: down and up, from left to right.
Outline folds(double half_length, double half_width, int count, double thickness) {
  Outline there, back;
  for (int i = 0; i <= count; ++i) {
    const double x = half_length * (2.0 * i / count - 1), room = 1 - x * x / (1.15 * half_length * half_length);
    const double y = (i % 2 ? 1 : -1) * half_width * std::sqrt(room);
    const double shift_y = i % 2 ? thickness : -thickness;
    there.push_back({x - thickness, y});
    there.push_back({x + thickness, y});
    back.push_back({x - 0.45 * thickness, y - 2 * shift_y});
    back.push_back({x + 0.45 * thickness, y - 2 * shift_y});
  }
  Outline outline;
  for (int i = 0; i <= count; ++i) {
    const auto k = 2 * static_cast<std::size_t>(i);
    const Outline& side = i % 2 ? back : there;
    outline.push_back(side[k]);
    outline.push_back(side[k + 1]);
  }
  for (int i = count; i >= 0; --i) {
    const auto k = 2 * static_cast<std::size_t>(i);
    const Outline& side = i % 2 ? there : back;
    outline.push_back(side[k + 1]);
    outline.push_back(side[k]);
  }
  return outline;
}

} // namespace

Shape mitochondrion(int outer, int inner, int crista) {
  Shape shape = moved(bowl(0.5, 0.05, 20, 6, outer, inner), stretch(2, 1, 1));
  const Shape band = extrude(folds(0.74, 0.36, 10, 0.028), {}, 0.3);
  append(shape, painted(moved(band, shift(0, -0.15, 0) * turn({1, 0, 0}, -90)), crista));
  return shape;
}

Shape virus(double radius, int capsid, int spike) {
  Shape shape = painted(creased(icosphere(radius, 4), 0.995), capsid);
  const Shape club = painted(lathe({{0, 0}, {0.05, 0}, {0.035, 0.24}, {0.1, 0.32}, {0, 0.4}}, 5), spike);
  for (const Face& face : icosphere(1, 1)) {
    const Vec3 middle = (face.points[0] + face.points[1] + face.points[2]) / 3.0;
    append(shape, moved(club, pointing(0.93 * radius * glm::normalize(middle), 2.0 * middle)));
  }
  for (int i = 0; i < 12; ++i) {
    const Vec2 c = circle((i % 5) * 0.2 + (i < 5 ? 0.1 : 0));
    const double high = std::sqrt(0.2), wide = 2 * high;
    const Vec3 corner = i < 10 ? Vec3(wide * c.x, i < 5 ? high : -high, -wide * c.y) : Vec3(0, i == 10 ? 1 : -1, 0);
    append(shape, moved(club, pointing(0.95 * radius * corner, 2.0 * corner)));
  }
  return shape;
}

Shape red_blood_cell(double radius, int material) {
  // Evans and Fung (1972): thickness of an erythrocyte over its radius.
  const auto half_height = [](double r) {
    return 0.5 * std::sqrt(1 - r * r) * (0.207 + 2.003 * r * r - 1.123 * r * r * r * r) * 0.9;
  };
  std::vector<Vec2> profile;
  const int rings = 6;
  for (int i = 0; i <= rings; ++i) {
    const double r = circle(0.25 * i / rings - 0.25).x;
    profile.push_back(radius * Vec2(r, i == rings ? 0 : -half_height(r)));
  }
  for (int i = rings - 1; i >= 0; --i)
    profile.push_back({profile[static_cast<std::size_t>(i)].x, -profile[static_cast<std::size_t>(i)].y});
  return painted(lathe(profile, 20), material);
}

namespace {

Vec3 random_direction(int i, std::uint32_t seed) {
  const double y = 2 * random_at(i, 0, seed) - 1, r = std::sqrt(1 - y * y);
  const Vec2 c = circle(random_at(i, 1, seed));
  return {r * c.x, y, r * c.y};
}

} // namespace

Shape white_blood_cell(double radius, int material) {
  Shape shape = icosphere(1, 6);
  for (Face& face : shape)
    for (Vec3& p : face.points) {
      const Vec3 n = glm::normalize(p);
      double bump = 0;
      for (int i = 0; i < 40; ++i) bump = std::max(bump, ramp(0.9, 0.99, glm::dot(n, random_direction(i, 23))));
      p = on_grid(n * radius * (0.86 + 0.26 * bump));
    }
  return painted(creased(shape, 0.3), material);
}

Shape bacterium(int body, int flagellum) {
  std::vector<Vec2> profile;
  for (int i = 0; i <= 4; ++i) profile.push_back(0.3 * circle(i / 16.0 - 0.25) + Vec2(0, 0.3));
  for (int i = 0; i <= 4; ++i) profile.push_back(0.3 * circle(i / 16.0) + Vec2(0, 1.1));
  Shape shape = painted(lathe(profile, 15), body);
  for (int k = 0; k < 3; ++k) {
    std::vector<Vec3> path;
    std::vector<double> radii;
    for (int i = 0; i <= 22; ++i) {
      const Vec2 c = circle(k / 3.0 + i / 9.0), out = circle(k / 3.0);
      const double spread = 0.12 + 0.006 * i;
      path.emplace_back(0.1 * out.x + spread * c.x * std::min(1.0, i / 4.0), 0.1 - 0.075 * i,
                        0.1 * out.y + spread * c.y * std::min(1.0, i / 4.0));
      radii.push_back(0.026 - 0.0008 * i);
    }
    append(shape, painted(tube(path, radii, 4), flagellum));
  }
  for (int i = 0; i < 27; ++i) {
    const Vec2 c = circle(random_at(i, 3, 7));
    const double y = 0.3 + 0.8 * random_at(i, 4, 7);
    append(shape, painted(tube({{0.27 * c.x, y, 0.27 * c.y}, {0.44 * c.x, y + 0.05, 0.44 * c.y}}, {0.014, 0.008}, 3),
                          flagellum));
  }
  return shape;
}

Shape diatom(double radius, double height, int shell) {
  const double h = 0.5 * height;
  const Shape shape = lathe({{0, -1.1 * h},
                             {0.5 * radius, -1.06 * h},
                             {0.9 * radius, -h},
                             {radius, -0.8 * h},
                             {radius, 0.8 * h},
                             {0.9 * radius, h},
                             {0.5 * radius, 1.06 * h},
                             {0, 1.1 * h}},
                            28);
  return painted(remapped(shape, Vec2(0), Vec2(14, 6)), shell);
}

namespace {

struct Branching {
  int sides, pieces;
  double length, thickness;
};

constexpr std::array<Branching, 3> branchings = {{{6, 7, 1.5, 0.11}, {5, 5, 0.9, 0.06}, {3, 4, 0.55, 0.035}}};

/// A branch that wanders off in a direction, with two smaller ones at its end.
void append_branch(Shape& shape, const Vec3& start, const Vec3& direction, std::size_t level, int number) {
  const Branching& b = branchings[level];
  std::vector<Vec3> path = {start};
  std::vector<double> radii = {b.thickness};
  Vec3 way = direction;
  for (int i = 1; i < b.pieces; ++i) {
    way = glm::normalize(way + 0.35 * random_direction(number * 16 + i, 61));
    path.push_back(path.back() + way * (b.length / (b.pieces - 1)));
    radii.push_back(b.thickness * (1 - 0.6 * i / (b.pieces - 1)));
  }
  append(shape, tube(path, radii, b.sides));
  if (level + 1 == branchings.size()) return;
  const Vec3 aside = glm::normalize(glm::cross(way, random_direction(number, 67)));
  for (const double side : {-0.7, 0.7})
    append_branch(shape, path.back() - 0.03 * way, glm::normalize(way + side * aside), level + 1,
                  2 * number + (side > 0 ? 1 : 0));
}

/// Points between the given ones on a Catmull-Rom curve.
std::vector<Vec3> smoothed(const std::vector<Vec3>& knots, int pieces) {
  std::vector<Vec3> path;
  const auto knot = [&](std::size_t i, int step) {
    const auto k = std::clamp(static_cast<std::ptrdiff_t>(i) + step, std::ptrdiff_t{0},
                              static_cast<std::ptrdiff_t>(knots.size()) - 1);
    return knots[static_cast<std::size_t>(k)];
  };
  for (std::size_t i = 0; i + 1 < knots.size(); ++i)
    for (int j = 0; j < pieces; ++j) {
      const double t = static_cast<double>(j) / pieces;
      const Vec3 a = knot(i, -1), b = knot(i, 0), c = knot(i, 1), d = knot(i, 2);
      path.push_back(b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a))));
    }
  path.push_back(knots.back());
  return path;
}

} // namespace

Shape neuron(const std::vector<Vec3>& axon, int body, int sheath) {
  Shape shape = icosphere(0.5, 4);
  const std::array<Vec3, 7> ways = {Vec3(0.2, 1, 0.3),    Vec3(-1, 0.6, 0.4),  Vec3(-0.8, -0.4, 0.7),
                                    Vec3(0.5, -0.9, 0.3), Vec3(-0.5, 0.3, -1), Vec3(0.7, 0.4, -0.8),
                                    Vec3(0.1, -0.6, -0.9)};
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Vec3 way = glm::normalize(ways[i]);
    append_branch(shape, 0.4 * way, way, 0, static_cast<int>(i) + 1);
  }
  const std::vector<Vec3> path = smoothed(axon, 6);
  append(shape, tube(path, std::vector<double>(path.size(), 0.06), 5));
  shape = painted(shape, body);
  for (std::size_t i = 2; i + 3 < path.size(); i += 4) {
    const std::vector<Vec3> piece = {path[i], path[i + 1], path[i + 2], path[i + 3]};
    append(shape, painted(tube(piece, {0.1, 0.15, 0.15, 0.1}, 8), sheath));
  }
  return shape;
}

} // namespace domewarp::test_scenes
