// SPDX-License-Identifier: Apache-2.0
// The part of the oracle that judges faces.
#include <algorithm>
#include <array>

#include <glm/geometric.hpp>

#include "domewarp/mesh/weld.h"
#include "domewarp/refine/edge_oracle.h"

namespace domewarp {

namespace {

int lowest(const Vec3& v) { return v.y < v.x ? (v.z < v.y ? 2 : 1) : (v.z < v.x ? 2 : 0); }

double lowest_of(const Vec3& v) { return v[lowest(v)]; }

} // namespace

bool EdgeOracle::looks_good(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, std::size_t& evaluations) const {
  constexpr double third = 1.0 / 3.0;
  for (const Vec3& weights : {Vec3(third), Vec3(0.5, 0.25, 0.25), Vec3(0.25, 0.5, 0.25), Vec3(0.25, 0.25, 0.5)}) {
    ++evaluations;
    if (interior_error(a, b, c, weights) > options_.tolerance) return false;
  }
  return true;
}

// Two sides have arches, and on every segment parallel to the third the second derivative is that along it. Three such
// bounds are open; the side with the lowest arch promises the least.
bool EdgeOracle::is_good(const std::array<const MappedPoint*, 3>& corner, const std::array<SideBound, 3>& side, int depth, std::size_t& evaluations) const {
  const int k = lowest({side[0].arch, side[1].arch, side[2].arch}), l = (k + 1) % 3, m = (k + 2) % 3;
  const MappedPoint &a = *corner[k], &b = *corner[l], &c = *corner[m];
  const Vec3 weights(a.mapped.weight, b.mapped.weight, c.mapped.weight);
  const double inner = bound_.face(a, b, c, weights, b.eye - a.eye, weights.y - weights.x) / (8 * lowest_of(weights));
  if (peak_face(Vec3(0), {inner, side[l].arch, side[m].arch}) <= options_.face_tolerance) return true;

  std::array<int, 3> order{0, 1, 2}; // must not depend on how the face is stored
  std::sort(order.begin(), order.end(), [&](int p, int q) { return precedes(corner[p]->eye, corner[q]->eye); });
  std::array<DrawnPoint, 3> drawn_corner, middle;
  for (int i = 0; i < 3; ++i) drawn_corner[i] = drawn(*corner[order[i]]);
  for (int i = 0; i < 3; ++i) {
    const int from = order[i], to = order[(i + 1) % 3];
    const double known = side[to == (from + 1) % 3 ? from : to].middle;
    const DrawnPoint &p = drawn_corner[i], &q = drawn_corner[(i + 1) % 3];
    middle[i] = known < 0 ? between(p, q) : halfway(p, q);
    if (known >= 0) middle[i].off = known * middle[i].weight;
    evaluations += known < 0;
  }
  return is_good_in_parts(drawn_corner, middle, depth, evaluations);
}

// What the middles of the sides are off by is known; the bounds of the four parts cover the rest.
bool EdgeOracle::is_good_in_parts(const std::array<DrawnPoint, 3>& corner, const std::array<DrawnPoint, 3>& middle, int depth,
                                  std::size_t& evaluations) const {
  for (const DrawnPoint& m : middle)
    if (m.off > options_.face_tolerance * m.weight) return false;
  const auto second = [&](const DrawnPoint& p, const DrawnPoint& q) { return bound_.edge(p, q, p.weight, q.weight).second; };
  Vec3 inner;
  for (int k = 0; k < 3; ++k) inner[k] = second(middle[k], middle[(k + 1) % 3]);
  if (!is_part_good(middle, inner, depth, evaluations)) return false;
  for (int k = 0; k < 3; ++k) {
    const int before = (k + 2) % 3;
    const Vec3 seconds(second(corner[k], middle[k]), inner[before], second(middle[before], corner[k]));
    if (!is_part_good({corner[k], middle[k], middle[before]}, seconds, depth, evaluations)) return false;
  }
  return true;
}

/// @param seconds second derivatives along the sides
bool EdgeOracle::is_part_good(const std::array<DrawnPoint, 3>& corner, const Vec3& seconds, int depth, std::size_t& evaluations) const {
  const int k = lowest(seconds);
  const DrawnPoint &a = corner[k], &b = corner[(k + 1) % 3], &c = corner[(k + 2) % 3];
  const Vec3 weights(a.weight, b.weight, c.weight);
  const double inner = bound_.face(a, b, c, weights, b.eye - a.eye, b.weight - a.weight), least = lowest_of(weights);
  const Vec3 arches = Vec3(inner, seconds[(k + 1) % 3], seconds[(k + 2) % 3]) / (8 * least);
  if (peak_face(Vec3(a.off, b.off, c.off) / least, arches) <= options_.face_tolerance) return true;
  if (depth == 1) return false;
  std::array<DrawnPoint, 3> middle;
  for (int i = 0; i < 3; ++i) middle[i] = between(corner[i], corner[(i + 1) % 3]);
  evaluations += 3;
  return is_good_in_parts(corner, middle, depth - 1, evaluations);
}

double EdgeOracle::interior_error(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& weights) const {
  const Vec3 drawn = homogeneous(a.mapped) * weights.x + homogeneous(b.mapped) * weights.y + homogeneous(c.mapped) * weights.z;
  const Mapped exact = map_point(a.eye * weights.x + b.eye * weights.y + c.eye * weights.z);
  return glm::length(dehomogenise(drawn) - exact.image);
}

} // namespace domewarp
