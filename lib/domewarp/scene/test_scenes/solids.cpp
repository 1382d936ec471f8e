// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/test_scenes/solids.h"

#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

namespace domewarp::test_scenes {

namespace {

/// Makes a face of a convex shape around the origin point outwards.
void append_outward(Shape& shape, const Vec3& a, const Vec3& b, const Vec3& c) {
  Face face{{on_grid(a), on_grid(b), on_grid(c)}, {Vec2(0), Vec2(0), Vec2(0)}};
  if (glm::dot(area_normal(face), a + b + c) < 0) std::swap(face.points[1], face.points[2]);
  shape.push_back(face);
}

void append_outward(Shape& shape, const std::array<Vec3, 4>& p) {
  append_outward(shape, p[0], p[1], p[2]);
  append_outward(shape, p[0], p[2], p[3]);
}

Shape with_fitted_uvs(Shape shape, const Vec3& size) {
  return remapped(with_box_uvs(std::move(shape), size), Vec2(0.5), Vec2(1));
}

/// Calls visit(axis, j, k, half) for the three axes, j and k being the other two.
template <typename Visit>
void each_axis(Visit&& visit) {
  for (int i = 0; i < 3; ++i) visit(i, (i + 1) % 3, (i + 2) % 3);
}

Vec3 vector_of(int i, double a, int j, double b, int k, double c) {
  Vec3 v;
  v[i] = a;
  v[j] = b;
  v[k] = c;
  return v;
}

} // namespace

Shape grid(int rows, int columns, const PointAt& point) {
  Shape shape;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const Vec3 p0 = on_grid(point(r, c)), p3 = on_grid(point(r + 1, c));
      const Vec3 p1 = on_grid(point(r, c + 1)), p2 = on_grid(point(r + 1, c + 1));
      const double u0 = static_cast<double>(c) / columns, u1 = (c + 1.0) / columns, um = 0.5 * (u0 + u1);
      const double v0 = 1 - static_cast<double>(r) / rows, v1 = 1 - (r + 1.0) / rows;
      const bool low_pole = p0 == p1, high_pole = p2 == p3;
      append_quad(shape, {p0, p1, p2, p3},
                  {Vec2(low_pole ? um : u0, v0), Vec2(low_pole ? um : u1, v0), Vec2(high_pole ? um : u1, v1),
                   Vec2(high_pole ? um : u0, v1)});
    }
  return shape;
}

Shape panel(double width, double height) {
  return grid(1, 1, [&](int row, int column) { return Vec3((column - 0.5) * width, (row - 0.5) * height, 0); });
}

Shape box(const Vec3& size) {
  Shape shape;
  const Vec3 h = 0.5 * size;
  each_axis([&](int i, int j, int k) {
    for (const double side : {-h[i], h[i]})
      append_outward(shape, {vector_of(i, side, j, -h[j], k, -h[k]), vector_of(i, side, j, h[j], k, -h[k]),
                             vector_of(i, side, j, h[j], k, h[k]), vector_of(i, side, j, -h[j], k, h[k])});
  });
  return with_fitted_uvs(std::move(shape), size);
}

Shape bevelled_box(const Vec3& size, double bevel) {
  Shape shape;
  const Vec3 h = 0.5 * size, b = h - bevel;
  each_axis([&](int i, int j, int k) {
    for (const double s : {-1.0, 1.0}) {
      append_outward(shape, {vector_of(i, s * h[i], j, -b[j], k, -b[k]), vector_of(i, s * h[i], j, b[j], k, -b[k]),
                             vector_of(i, s * h[i], j, b[j], k, b[k]), vector_of(i, s * h[i], j, -b[j], k, b[k])});
      for (const double t : {-1.0, 1.0})
        append_outward(shape,
                       {vector_of(i, -b[i], j, s * h[j], k, t * b[k]), vector_of(i, b[i], j, s * h[j], k, t * b[k]),
                        vector_of(i, b[i], j, s * b[j], k, t * h[k]), vector_of(i, -b[i], j, s * b[j], k, t * h[k])});
    }
  });
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 s(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    append_outward(shape, s * Vec3(h.x, b.y, b.z), s * Vec3(b.x, h.y, b.z), s * Vec3(b.x, b.y, h.z));
  }
  return with_fitted_uvs(std::move(shape), size);
}

Shape lathe(const std::vector<Vec2>& profile, int sides) {
  std::vector<double> along = {0};
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const Vec2 d = profile[i] - profile[i - 1];
    along.push_back(along.back() + std::sqrt(d.x * d.x + d.y * d.y));
  }
  const int rows = static_cast<int>(profile.size()) - 1;
  Shape shape = grid(rows, sides, [&](int row, int column) {
    const Vec2 p = profile[static_cast<std::size_t>(row)];
    const Vec2 c = circle(static_cast<double>(column % sides) / sides);
    return Vec3(p.x * c.x, p.y, -p.x * c.y);
  });
  for (Face& face : shape)
    for (Vec2& uv : face.uvs)
      uv.y = 1 - along[static_cast<std::size_t>(std::floor((1 - uv.y) * rows + 0.5))] / along.back();
  return shape;
}

Shape cylinder(double radius, double height, int sides) {
  return lathe({{0, 0}, {radius, 0}, {radius, height}, {0, height}}, sides);
}

Shape sphere(double radius, int sides, int rings) {
  std::vector<Vec2> profile;
  for (int i = 0; i <= rings; ++i) profile.push_back(radius * circle(0.5 * i / rings - 0.25));
  return lathe(profile, sides);
}

Shape torus(double radius, double tube_radius, int sides, int tube_sides) {
  std::vector<Vec2> profile;
  for (int i = 0; i <= tube_sides; ++i)
    profile.push_back(Vec2(radius, 0) + tube_radius * circle(static_cast<double>(i % tube_sides) / tube_sides));
  return lathe(profile, sides);
}

namespace {

using Triangle = std::array<Vec3, 3>;

/// The faces of an icosahedron of no particular size.
std::vector<Triangle> icosahedron() {
  const double high = std::sqrt(0.2), wide = 2 * high;
  auto ring = [&](int i, bool top) {
    const Vec2 c = circle((top ? 0.1 : 0) + (i % 5) * 0.2);
    return Vec3(wide * c.x, top ? high : -high, -wide * c.y);
  };
  const Vec3 north(0, 1, 0), south(0, -1, 0);
  std::vector<Triangle> faces;
  for (int i = 0; i < 5; ++i) {
    faces.push_back({ring(i, true), ring(i + 1, true), north});
    faces.push_back({ring(i + 1, false), ring(i, false), south});
    faces.push_back({ring(i, false), ring(i + 1, false), ring(i, true)});
    faces.push_back({ring(i, true), ring(i + 1, false), ring(i + 1, true)});
  }
  return faces;
}

} // namespace

Shape icosphere(double radius, int frequency) {
  Shape shape;
  for (const Triangle& t : icosahedron()) {
    auto point = [&](int i, int j) {
      const Vec3 p = (t[0] * double(frequency - i - j) + t[1] * double(i) + t[2] * double(j)) / double(frequency);
      return radius / std::sqrt(glm::dot(p, p)) * p;
    };
    for (int j = 0; j < frequency; ++j)
      for (int i = 0; i < frequency - j; ++i) {
        append_outward(shape, point(i, j), point(i + 1, j), point(i, j + 1));
        if (i + j + 1 < frequency) append_outward(shape, point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
      }
  }
  return with_fitted_uvs(std::move(shape), Vec3(2 * radius));
}

namespace {

struct Frame {
  Vec3 right, up;
};

Vec3 direction(const std::vector<Vec3>& path, std::size_t i, bool closed) {
  const std::size_t n = path.size();
  const Vec3& before = path[i > 0 ? i - 1 : closed ? n - 1 : 0];
  const Vec3& after = path[i + 1 < n ? i + 1 : closed ? 0 : n - 1];
  return glm::normalize(after - before);
}

/// Frames across the path that turn as little as possible from point to point.
std::vector<Frame> frames_along(const std::vector<Vec3>& path, bool closed) {
  std::vector<Frame> frames;
  const Vec3 d = direction(path, 0, closed);
  Vec3 right = std::abs(d.y) < 0.9 ? Vec3(-d.z, 0, d.x) : Vec3(0, d.z, -d.y);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vec3 forward = direction(path, i, closed);
    right = glm::normalize(right - forward * glm::dot(right, forward));
    frames.push_back({right, glm::cross(right, forward)});
  }
  return frames;
}

Vec3 around(const Vec3& centre, const Frame& frame, double radius, int column, int sides) {
  const Vec2 c = circle(static_cast<double>(column % sides) / sides);
  return centre + radius * (c.x * frame.right - c.y * frame.up);
}

} // namespace

Shape tube(const std::vector<Vec3>& path, const std::vector<double>& radii, int sides) {
  const std::vector<Frame> frames = frames_along(path, false);
  const int last = static_cast<int>(path.size()) + 1;
  return grid(last, sides, [&](int row, int column) {
    if (row == 0) return path.front();
    if (row == last) return path.back();
    const auto i = static_cast<std::size_t>(row - 1);
    return around(path[i], frames[i], radii[i], column, sides);
  });
}

Shape loop_tube(const std::vector<Vec3>& path, double radius, int sides) {
  const std::vector<Frame> frames = frames_along(path, true);
  return grid(static_cast<int>(path.size()), sides, [&](int row, int column) {
    const std::size_t i = static_cast<std::size_t>(row) % path.size();
    return around(path[i], frames[i], radius, column, sides);
  });
}

namespace {

/// The points of a screw thread: root and crest run up side by side, half a pitch apart. The end rings are narrower
/// than the root, so that no corner of the two steps lies on another edge.
struct ScrewThread {
  double core, crest, pitch;
  int turns, sides;

  Vec3 at(double radius, double height, int k) const {
    const Vec2 c = circle(static_cast<double>(k % sides) / sides);
    return {radius * c.x, height, -radius * c.y};
  }
  Vec3 root_point(int k) const { return at(core, pitch * (0.5 + static_cast<double>(k) / sides), k); }
  Vec3 crest_point(int k) const { return at(crest, pitch * (1 + static_cast<double>(k) / sides), k); }
  Vec3 bottom(int k) const { return at(0.9 * core, 0, k); }
  Vec3 top(int k) const { return at(0.9 * core, height(), k); }
  double height() const { return pitch * (turns + 2); }
};

void append_triangle(Shape& shape, const Vec3& a, const Vec3& b, const Vec3& c) {
  shape.push_back({{on_grid(a), on_grid(b), on_grid(c)}, {Vec2(0), Vec2(0), Vec2(0)}});
}

void append_quad(Shape& shape, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  append_triangle(shape, a, b, c);
  append_triangle(shape, a, c, d);
}

} // namespace

Shape screw_thread(double core_radius, double crest_radius, double pitch, int turns, int sides) {
  const ScrewThread t{core_radius, crest_radius, pitch, turns, sides};
  Shape shape;
  const int end = turns * sides;
  for (int k = 0; k < end; ++k) {
    append_quad(shape, t.root_point(k), t.root_point(k + 1), t.crest_point(k + 1), t.crest_point(k));
    append_quad(shape, t.crest_point(k), t.crest_point(k + 1), t.root_point(k + 1 + sides), t.root_point(k + sides));
  }
  for (int k = 0; k < sides; ++k) {
    append_quad(shape, t.bottom(k), t.bottom(k + 1), t.root_point(k + 1), t.root_point(k));
    append_quad(shape, t.root_point(end + k), t.root_point(end + k + 1), t.top(k + 1), t.top(k));
    append_triangle(shape, Vec3(0), t.bottom(k + 1), t.bottom(k));
    append_triangle(shape, Vec3(0, t.height(), 0), t.top(k), t.top(k + 1));
  }
  append_quad(shape, t.root_point(0), t.crest_point(0), t.root_point(sides), t.bottom(0));
  append_quad(shape, t.root_point(end + sides), t.crest_point(end), t.root_point(end), t.top(0));
  return with_box_uvs(std::move(shape), Vec3(4 * crest_radius));
}

} // namespace domewarp::test_scenes
