// SPDX-License-Identifier: Apache-2.0
// Based on: Pottmann et al. 2000 and Nadler 1986 for the density of optimal interpolating triangulations (a scalar
// function of definite Hessian needs E_1 = 2 / (3 sqrt 3) sqrt|det H|), here for a map to the plane.
#include "lower_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"

namespace domewarp::bench {

namespace {

constexpr double pi = std::numbers::pi;

/// By how much the middle of the segment d lies off its chord.
Vec2 bulge(const Hessian& h, const Vec2& d) { return (h[0] * (d.x * d.x) + h[1] * (2 * d.x * d.y) + h[2] * (d.y * d.y)) / 8.0; }

/// Sides of triangles of unit area: an equilateral one turned, stretched, and turned again.
using Sides = std::array<Vec2, 3>;

std::vector<Sides> make_shapes() {
  std::vector<Sides> shapes;
  const double side = 2 / std::pow(3.0, 0.25);
  for (int s = 0; s < 27; ++s)
    for (int direction = 0; direction < (s == 0 ? 1 : 24); ++direction)
      for (int turn = 0; turn < 8; ++turn) {
        const double stretch = std::pow(1.18, s), along = pi * direction / 24, c = std::cos(along), n = std::sin(along);
        Sides sides;
        for (int k = 0; k < 3; ++k) {
          const double angle = 2 * pi * k / 3 + pi / 3 * turn / 8;
          const Vec2 d = side * Vec2(std::cos(angle) * stretch, std::sin(angle) / stretch);
          sides[k] = {c * d.x - n * d.y, n * d.x + c * d.y};
        }
        shapes.push_back(sides);
      }
  return shapes;
}

double largest_error(const Hessian& h, const Sides& sides) {
  std::array<Vec2, 3> middle; // of the error, which is 4 sum over sides of l_i l_j middle_ij
  for (int k = 0; k < 3; ++k) middle[k] = bulge(h, sides[k]);
  const Vec2 all = middle[0] + middle[1] + middle[2];
  double worst = glm::dot(all, all) * (16.0 / 81);
  for (const Vec2& m : middle) worst = std::max(worst, glm::dot(m, m));
  for (int k = 0; k < 3; ++k) { // at l = (1/2, 1/4, 1/4)
    const Vec2 e = 0.5 * middle[k] + 0.5 * middle[(k + 2) % 3] + 0.25 * middle[(k + 1) % 3];
    worst = std::max(worst, glm::dot(e, e));
  }
  return std::sqrt(worst);
}

Hessian hessian_at(const BranchMap& map, const Vec3& p, const Vec3& u, const Vec3& v) {
  const double h = 1e-3 * glm::length(p);
  const auto at = [&](double i, double j) { return map.image(p + u * (i * h) + v * (j * h)); };
  const Vec2 here = at(0, 0);
  return {(at(1, 0) + at(-1, 0) - 2.0 * here) / (h * h), (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h),
          (at(0, 1) + at(0, -1) - 2.0 * here) / (h * h)};
}

double density_over(const BranchMap& map, const std::array<Vec3, 3>& corner, int parts) {
  const Vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0], normal = glm::cross(ab, ac);
  const Vec3 u = glm::normalize(ab), v = glm::normalize(glm::cross(normal, ab));
  double sum = 0;
  for (int i = 0; i < parts; ++i)
    for (int j = 0; i + j < parts; ++j)
      for (int flipped = 0; flipped < (i + j < parts - 1 ? 2 : 1); ++flipped) {
        const double third = flipped ? 2.0 / 3 : 1.0 / 3;
        const Vec3 p = corner[0] + ab * ((i + third) / parts) + ac * ((j + third) / parts);
        const Vec2 inside = map.inside(p);
        if (inside.x >= 0 && inside.y >= 0) sum += least_error(hessian_at(map, p, u, v));
      }
  return sum * 0.5 * glm::length(normal) / (parts * parts);
}

} // namespace

double least_error(const Hessian& hessian) {
  static const std::vector<Sides> shapes = make_shapes();
  double least = std::numeric_limits<double>::infinity();
  for (const Sides& sides : shapes) least = std::min(least, largest_error(hessian, sides));
  return least;
}

double least_triangles(const Scene& scene, const BranchMap& map, double tolerance, int parts) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
      for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        std::array<Vec3, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) corner[k] = Vec3(primitive.positions[primitive.indices[i + k]]);
        triangles.push_back(corner);
      }
  std::vector<double> sums(triangles.size());
  parallel_each(triangles.size(), 1, [&](std::size_t i) { sums[i] = density_over(map, triangles[i], parts); });
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum / tolerance;
}

} // namespace domewarp::bench
