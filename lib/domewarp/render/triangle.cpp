// SPDX-License-Identifier: Apache-2.0
//
// Based on: signed volumes after Kensler and Shirley, Optimizing Ray-Triangle Intersection, 2006.
#include "domewarp/render/triangle.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace domewarp {

namespace {

constexpr double longest_mitre = 1000;

} // namespace

double largest(const Vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

void inflate(const Vec3 (&v)[3], double margin, Vec3 (&out)[3]) {
  const Vec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
  const double area = glm::length(normal);
  Vec3 outward[3];
  for (int i = 0; i < 3; ++i) outward[i] = glm::normalize(glm::cross(v[(i + 1) % 3] - v[i], normal / area));
  for (int i = 0; i < 3; ++i) {
    const Vec3& a = outward[i];
    const Vec3& b = outward[(i + 2) % 3];
    const double mitre = 1 / std::max(1 + glm::dot(a, b), 2 / (longest_mitre * longest_mitre));
    out[i] = v[i] + margin * mitre * (a + b);
  }
}

double distance_slack(const Vec3 (&v)[3]) {
  const Pyramid pyramid = make_pyramid(v);
  const double reach = std::max({largest(v[0]), largest(v[1]), largest(v[2])});
  const double height = std::abs(pyramid.volume) / glm::length(pyramid.sides[0] + pyramid.sides[1] + pyramid.sides[2]);
  return std::min(4e-6 + 2e-6 * reach / height, 1e-2);
}

std::optional<std::array<double, 3>> weights_near(const Vec3 (&v)[3], const Vec3& p, double tolerance) {
  const Vec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
  const double area = glm::length(normal);
  if (!(area > 0) || !(std::abs(glm::dot(normal, p - v[0])) <= tolerance * area)) return std::nullopt;
  std::array<double, 3> weights{};
  for (int i = 0; i < 3; ++i) {
    const Vec3& a = v[(i + 1) % 3];
    const Vec3 side = v[(i + 2) % 3] - a;
    const double from_side = glm::dot(normal, glm::cross(side, p - a)) / area; // times the side's length
    if (from_side < -tolerance * glm::length(side)) return std::nullopt;
    weights[std::size_t(i)] = from_side / area;
  }
  return weights;
}

} // namespace domewarp
