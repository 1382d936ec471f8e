// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/test_scenes/shape.h"

#include <cmath>
#include <map>
#include <utility>

#include <glm/geometric.hpp>

namespace domewarp::test_scenes {

namespace {

constexpr double position_grid = 16384;
constexpr double attribute_grid = 4096;

double snap(double x, double grid) {
  return std::floor(x * grid + 0.5) / grid + 0.0;
}

template <typename Vector>
Vector snap_all(Vector v, double grid) {
  for (int i = 0; i < Vector::length(); ++i) v[i] = snap(v[i], grid);
  return v;
}

/// Sine by its series, for |x| <= pi / 4: the first term left out is below 1e-17.
double sine(double x) {
  const double s = x * x;
  double sum = 0;
  for (int n = 17; n > 1; n -= 2) sum = (1 + sum) * -s / (n * (n - 1));
  return x * (1 + sum);
}

double cosine(double x) {
  const double s = x * x;
  double sum = 0;
  for (int n = 18; n > 0; n -= 2) sum = (1 + sum) * -s / (n * (n - 1));
  return 1 + sum;
}

using Key = std::array<double, 3>;
Key key(const Vec3& p) {
  return {p.x, p.y, p.z};
}

} // namespace

Vec2 circle(double turns) {
  const double quarters = std::floor(turns * 4 + 0.5);
  const double x = (turns - quarters / 4) * 2 * pi;
  const double c = cosine(x), s = sine(x);
  const int quadrant = static_cast<int>(quarters - 4 * std::floor(quarters / 4));
  const std::array<Vec2, 4> turned = {Vec2(c, s), Vec2(-s, c), Vec2(-c, -s), Vec2(s, -c)};
  return turned[static_cast<std::size_t>(quadrant)];
}

Vec3 on_grid(const Vec3& p) {
  return snap_all(p, position_grid);
}
Vec2 on_grid(const Vec2& p) {
  return snap_all(p, position_grid);
}

Mat4 shift(double x, double y, double z) {
  Mat4 m(1);
  m[3] = Vec4(x, y, z, 1);
  return m;
}

Mat4 stretch(double x, double y, double z) {
  Mat4 m(1);
  m[0][0] = x;
  m[1][1] = y;
  m[2][2] = z;
  return m;
}

Mat4 turn(const Vec3& axis, double degrees) {
  const Vec3 a = axis / std::sqrt(glm::dot(axis, axis));
  const Vec2 cs = circle(degrees / 360);
  Mat4 m(1);
  for (int i = 0; i < 3; ++i) {
    Vec3 e(0);
    e[i] = 1;
    m[i] = Vec4(e * cs.x + glm::cross(a, e) * cs.y + a * (a[i] * (1 - cs.x)), 0);
  }
  return m;
}

Mat4 pointing(const Vec3& base, const Vec3& tip) {
  const Vec3 up = glm::normalize(tip - base);
  const Vec3 side = std::abs(up.x) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 0, -1);
  const Vec3 right = glm::normalize(side - up * glm::dot(side, up));
  return {Vec4(right, 0), Vec4(up, 0), Vec4(glm::cross(right, up), 0), Vec4(base, 1)};
}

Vec3 area_normal(const Face& face) {
  return glm::cross(face.points[1] - face.points[0], face.points[2] - face.points[0]);
}

void append(Shape& shape, const Shape& more) {
  shape.insert(shape.end(), more.begin(), more.end());
}

void append_quad(Shape& shape, const std::array<Vec3, 4>& points, const std::array<Vec2, 4>& uvs) {
  std::array<Vec3, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = on_grid(points[i]);
  if (p[0] != p[1] && p[1] != p[2]) shape.push_back({{p[0], p[1], p[2]}, {uvs[0], uvs[1], uvs[2]}});
  if (p[2] != p[3] && p[3] != p[0]) shape.push_back({{p[0], p[2], p[3]}, {uvs[0], uvs[2], uvs[3]}});
}

Shape moved(Shape shape, const Mat4& matrix) {
  for (Face& face : shape)
    for (Vec3& p : face.points) p = on_grid(Vec3(matrix * Vec4(p, 1)));
  return shape;
}

Shape painted(Shape shape, int material) {
  for (Face& face : shape) face.material = material;
  return shape;
}

Shape creased(Shape shape, double crease) {
  for (Face& face : shape) face.crease = crease;
  return shape;
}

Shape turned_inside_out(Shape shape) {
  for (Face& face : shape) {
    std::swap(face.points[1], face.points[2]);
    std::swap(face.uvs[1], face.uvs[2]);
  }
  return shape;
}

Shape remapped(Shape shape, const Vec2& offset, const Vec2& scale, int material) {
  for (Face& face : shape)
    for (Vec2& uv : face.uvs)
      if (material < 0 || face.material == material) uv = offset + uv * scale;
  return shape;
}

Shape with_box_uvs(Shape shape, const Vec3& size) {
  for (Face& face : shape) {
    const Vec3 n = area_normal(face), m(std::abs(n.x), std::abs(n.y), std::abs(n.z));
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 p = face.points[i] / size;
      if (m.z >= m.x && m.z >= m.y)
        face.uvs[i] = {n.z > 0 ? p.x : -p.x, -p.y};
      else if (m.x >= m.y)
        face.uvs[i] = {n.x > 0 ? -p.z : p.z, -p.y};
      else
        face.uvs[i] = {p.x, n.y > 0 ? p.z : -p.z};
    }
  }
  return shape;
}

Shape painted_towards(Shape shape, const Vec3& direction, double limit, int material) {
  for (Face& face : shape) {
    const Vec3 n = area_normal(face);
    if (glm::dot(n, direction) >= limit * std::sqrt(glm::dot(n, n))) face.material = material;
  }
  return shape;
}

namespace {

/// The faces around each position, and the area normals of all faces.
struct Neighbourhood {
  std::map<Key, std::vector<std::size_t>> around;
  std::vector<Vec3> normals;
};

Neighbourhood find_neighbours(const Shape& shape) {
  Neighbourhood result;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    result.normals.push_back(area_normal(shape[i]));
    for (const Vec3& p : shape[i].points) result.around[key(p)].push_back(i);
  }
  return result;
}

/// The area-weighted mean of the normals around a corner that do not cross a crease.
Vec3 corner_normal(const Shape& shape, const Neighbourhood& neighbours, std::size_t face, std::size_t corner) {
  const Vec3 own = glm::normalize(neighbours.normals[face]);
  Vec3 sum(0);
  for (const std::size_t other : neighbours.around.at(key(shape[face].points[corner]))) {
    const Vec3& n = neighbours.normals[other];
    if (other == face || glm::dot(own, glm::normalize(n)) > shape[face].crease) sum += n;
  }
  return snap_all(glm::normalize(sum), attribute_grid);
}

/// A primitive that is being filled, and where its vertices stand.
struct Filling {
  Primitive primitive;
  std::vector<float> normals, uvs, colors;
  std::map<std::array<double, 8>, std::uint32_t> vertices;
};

void put(std::vector<float>& values, double x) {
  values.push_back(static_cast<float>(x));
}

std::uint32_t add_vertex(Filling& to, const Vec3& p, const Vec3& n, const Vec2& uv, const ColorAt& color) {
  const auto next = static_cast<std::uint32_t>(to.primitive.positions.size());
  const auto [place, is_new] = to.vertices.try_emplace({p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y}, next);
  if (!is_new) return place->second;
  to.primitive.positions.emplace_back(p);
  for (int i = 0; i < 3; ++i) put(to.normals, n[i]);
  for (int i = 0; i < 2; ++i) put(to.uvs, uv[i]);
  if (!color) return next;
  const Vec3 c = snap_all(color(p), attribute_grid);
  for (int i = 0; i < 3; ++i) put(to.colors, c[i]);
  return next;
}

Primitive finish(Filling& filling, int material) {
  Primitive result = std::move(filling.primitive);
  result.material = material;
  result.attributes.push_back({"NORMAL", 3, std::move(filling.normals)});
  result.attributes.push_back({"TEXCOORD_0", 2, std::move(filling.uvs)});
  if (!filling.colors.empty()) result.attributes.push_back({"COLOR_0", 3, std::move(filling.colors)});
  return result;
}

} // namespace

Mesh make_mesh(const std::string& name, const Shape& shape, const ColorAt& color) {
  const Neighbourhood neighbours = find_neighbours(shape);
  std::map<int, Filling> fillings;
  for (std::size_t i = 0; i < shape.size(); ++i)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Filling& to = fillings[shape[i].material];
      const Vec2 uv = snap_all(shape[i].uvs[corner], attribute_grid);
      const Vec3 normal = corner_normal(shape, neighbours, i, corner);
      to.primitive.indices.push_back(add_vertex(to, shape[i].points[corner], normal, uv, color));
    }
  Mesh mesh{name, {}};
  for (auto& [material, filling] : fillings) mesh.primitives.push_back(finish(filling, material));
  return mesh;
}

} // namespace domewarp::test_scenes
