// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/test_scenes/outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "domewarp/core/errors.h"

namespace domewarp::test_scenes {

Outline rectangle(double width, double height) {
  const double w = 0.5 * width, h = 0.5 * height;
  return {{-w, -h}, {w, -h}, {w, h}, {-w, h}};
}

Outline regular_polygon(double radius, int sides, double start_turns) {
  Outline outline;
  for (int i = 0; i < sides; ++i) outline.push_back(radius * circle(start_turns + static_cast<double>(i) / sides));
  return outline;
}

Outline arc(const Vec2& centre, double radius, double from, double to, int pieces) {
  Outline outline;
  for (int i = 0; i <= pieces; ++i) outline.push_back(centre + radius * circle(from + (to - from) * i / pieces));
  return outline;
}

Outline gear_outline(double root_radius, double tip_radius, int teeth) {
  Outline outline;
  for (int i = 0; i < teeth; ++i) {
    outline.push_back(root_radius * circle((i - 0.30) / teeth));
    outline.push_back(tip_radius * circle((i - 0.14) / teeth));
    outline.push_back(tip_radius * circle((i + 0.14) / teeth));
    outline.push_back(root_radius * circle((i + 0.30) / teeth));
  }
  return outline;
}

Outline shifted(Outline outline, const Vec2& by) {
  for (Vec2& p : outline) p += by;
  return outline;
}

namespace {

/// Twice the signed area. Exact for points on the grid within a few hundred metres.
double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double distance2(const Vec2& a, const Vec2& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

bool crosses(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0;
}

bool crosses(const Vec2& a, const Vec2& b, const Outline& outline) {
  for (std::size_t i = 0; i < outline.size(); ++i)
    if (crosses(a, b, outline[i], outline[(i + 1) % outline.size()])) return true;
  return false;
}

Outline snapped(Outline outline) {
  for (Vec2& p : outline) p = on_grid(p);
  return outline;
}

/// The shortest way from a corner of the polygon to one of the hole that crosses neither of them nor another hole.
std::array<std::size_t, 2> find_bridge(const Outline& polygon, const Outline& hole, const std::vector<Outline>& holes) {
  std::array<std::size_t, 2> bridge = {};
  double best = HUGE_VAL;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    for (std::size_t j = 0; j < hole.size(); ++j) {
      const Vec2 a = polygon[i], b = hole[j];
      if (distance2(a, b) >= best || crosses(a, b, polygon)) continue;
      if (std::any_of(holes.begin(), holes.end(), [&](const Outline& other) { return crosses(a, b, other); })) continue;
      best = distance2(a, b);
      bridge = {i, j};
    }
  return bridge;
}

/// Cuts the polygon open along a bridge to the hole, so that one polygon is left.
Outline bridged(const Outline& polygon, const Outline& hole, const std::vector<Outline>& holes) {
  const auto [from, to] = find_bridge(polygon, hole, holes);
  Outline result(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(from) + 1);
  const std::size_t n = hole.size();
  for (std::size_t k = 0; k <= n; ++k) result.push_back(hole[(to + n - k) % n]);
  result.insert(result.end(), polygon.begin() + static_cast<std::ptrdiff_t>(from), polygon.end());
  return result;
}

bool is_inside(const Vec2& p, const std::array<Vec2, 3>& t) {
  if (p == t[0] || p == t[1] || p == t[2]) return false;
  return cross(t[0], t[1], p) >= 0 && cross(t[1], t[2], p) >= 0 && cross(t[2], t[0], p) >= 0;
}

/// Area over squared edge lengths: 0 for a flat triangle, largest for an equilateral one.
double roundness(const std::array<Vec2, 3>& t) {
  return cross(t[0], t[1], t[2]) / (distance2(t[0], t[1]) + distance2(t[1], t[2]) + distance2(t[2], t[0]));
}

std::array<Vec2, 3> corner(const Outline& polygon, std::size_t i) {
  const std::size_t n = polygon.size();
  return {polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]};
}

/// The roundest ear: with any other choice gears and rings come out as slivers.
std::size_t best_ear(const Outline& polygon) {
  double best = 0;
  std::size_t ear = polygon.size();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::array<Vec2, 3> t = corner(polygon, i);
    const double quality = roundness(t);
    if (!(quality > best)) continue;
    if (std::any_of(polygon.begin(), polygon.end(), [&](const Vec2& p) { return is_inside(p, t); })) continue;
    best = quality;
    ear = i;
  }
  if (ear == polygon.size()) throw Error(ErrorCode::usage, "triangulate: the outline crosses itself");
  return ear;
}

} // namespace

std::vector<std::array<Vec2, 3>> triangulate(const Outline& outer, const std::vector<Outline>& holes) {
  std::vector<Outline> open;
  for (const Outline& hole : holes) open.push_back(snapped(hole));
  Outline polygon = snapped(outer);
  for (const Outline& hole : open) polygon = bridged(polygon, hole, open);
  std::vector<std::array<Vec2, 3>> triangles;
  while (polygon.size() > 2) {
    const std::size_t ear = best_ear(polygon);
    triangles.push_back(corner(polygon, ear));
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

namespace {

/// A wall along the outline from z = low to z = high; its outer side is to the right of the way. u = length, v = depth.
Shape wall(const Outline& outline, double low, double high) {
  Shape shape;
  double u = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    const double next = u + std::sqrt(distance2(a, b)), v = high - low;
    append_quad(shape, {Vec3(a, low), Vec3(b, low), Vec3(b, high), Vec3(a, high)},
                {Vec2(u, v), Vec2(next, v), Vec2(next, 0), Vec2(u, 0)});
    u = next;
  }
  return shape;
}

Shape cap(const std::vector<std::array<Vec2, 3>>& triangles, double z) {
  Shape shape;
  for (const std::array<Vec2, 3>& t : triangles) {
    Face face;
    for (std::size_t i = 0; i < 3; ++i) {
      face.points[i] = on_grid(Vec3(t[i], z));
      face.uvs[i] = {t[i].x, -t[i].y};
    }
    shape.push_back(face);
  }
  return shape;
}

} // namespace

Shape extrude(const Outline& outer, const std::vector<Outline>& holes, double depth, int face_material,
              int side_material, int hole_material) {
  const std::vector<std::array<Vec2, 3>> triangles = triangulate(outer, holes);
  Shape shape = painted(cap(triangles, 0.5 * depth), face_material);
  append(shape, painted(turned_inside_out(cap(triangles, -0.5 * depth)), face_material));
  append(shape, painted(wall(outer, -0.5 * depth, 0.5 * depth), side_material));
  for (Outline hole : holes) {
    std::reverse(hole.begin(), hole.end());
    append(shape, painted(wall(hole, -0.5 * depth, 0.5 * depth), hole_material));
  }
  return shape;
}

Shape room(const Outline& plan, double height, int floor_material, int wall_material, int ceiling_material) {
  const std::vector<std::array<Vec2, 3>> triangles = triangulate(plan, {});
  Shape shape = painted(cap(triangles, 0), floor_material);
  append(shape, painted(turned_inside_out(cap(triangles, height)), ceiling_material));
  append(shape, painted(turned_inside_out(wall(plan, 0, height)), wall_material));
  return moved(std::move(shape), turn({1, 0, 0}, -90));
}

} // namespace domewarp::test_scenes
