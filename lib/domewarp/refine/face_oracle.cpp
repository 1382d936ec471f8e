// SPDX-License-Identifier: Apache-2.0
// The part of the oracle that judges faces.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "domewarp/mesh/weld.h"
#include "domewarp/refine/edge_oracle.h"

namespace domewarp {

namespace {

int lowest(const Vec3& v) { return v.y < v.x ? (v.z < v.y ? 2 : 1) : (v.z < v.x ? 2 : 0); }

double lowest_of(const Vec3& v) { return v[lowest(v)]; }

} // namespace

bool EdgeOracle::looks_good(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, double tolerance, FaceJudgement& judgement) const {
  constexpr double third = 1.0 / 3.0;
  for (const Vec3& weights : {Vec3(third), Vec3(0.5, 0.25, 0.25), Vec3(0.25, 0.5, 0.25), Vec3(0.25, 0.25, 0.5)}) {
    ++judgement.evaluations;
    const double depth = interior_depth_error(a, b, c, weights);
    if (interior_error(a, b, c, weights) > tolerance || depth > options_.face_depth_tolerance) return false;
    judgement.depth_error = std::max(judgement.depth_error, depth);
  }
  return true;
}

// Two sides have arches, and on every segment parallel to the third the second derivative is that along it. Three such
// bounds are open; the side with the lowest arch promises the least.
EdgeOracle::SortedFace EdgeOracle::bound_of(const std::array<const MappedPoint*, 3>& corner, const std::array<SideBound, 3>& side) const {
  std::array<int, 3> order{0, 1, 2}; // nothing may depend on how the face is stored
  const auto sort_two = [&](int i, int j) {
    if (precedes(corner[order[j]]->eye, corner[order[i]]->eye)) std::swap(order[i], order[j]);
  };
  sort_two(0, 1);
  sort_two(1, 2);
  sort_two(0, 1);
  SortedFace face;
  Vec3 weights, arches;
  for (int i = 0; i < 3; ++i) {
    const int from = order[i], to = order[(i + 1) % 3];
    face.corner[i] = corner[from];
    face.side[i] = side[to == (from + 1) % 3 ? from : to];
    weights[i] = face.corner[i]->mapped.weight;
    arches[i] = face.side[i].arch;
  }
  const FaceBend bend = bound_.face({face.corner[0], face.corner[1], face.corner[2]}, weights, true);
  const int k = lowest(arches);
  arches[k] = bend.second[k] / (8 * lowest_of(weights));
  face.second = bend.second;
  face.error = peak_face(Vec3(0), arches);
  face.depth_error = peak_depth(Vec3(0), bend.depth);
  return face;
}

bool EdgeOracle::is_good(const std::array<const MappedPoint*, 3>& corner, const std::array<SideBound, 3>& side, int depth, FaceJudgement& judgement) const {
  return is_within(bound_of(corner, side), {options_.face_tolerance, options_.face_depth_tolerance}, depth, judgement);
}

bool EdgeOracle::is_within(const SortedFace& face, const FaceLimits& limits, int depth, FaceJudgement& judgement) const {
  const bool has_depth = face.depth_error <= limits.depth_error;
  if (has_depth) judgement.depth_error = std::max(judgement.depth_error, face.depth_error);
  if (has_depth && face.error <= limits.error) return true;

  std::array<DrawnPoint, 3> drawn_corner, middle;
  for (int i = 0; i < 3; ++i) drawn_corner[i] = drawn(*face.corner[i]);
  for (int i = 0; i < 3; ++i) {
    const DrawnPoint &p = drawn_corner[i], &q = drawn_corner[(i + 1) % 3];
    const bool is_known = face.side[i].middle >= 0;
    middle[i] = is_known ? halfway(p, q) : between(p, q);
    if (is_known) middle[i].off = face.side[i].middle * middle[i].weight;
    if (is_known) middle[i].depth_off = face.side[i].depth;
    judgement.evaluations += !is_known;
  }
  return are_parts_good(drawn_corner, middle, {0.25 * face.second, depth, has_depth, limits}, judgement);
}

// What the middles of the sides are off by is known; the bounds of the four parts cover the rest. Side k of each part is
// parallel to side k of the whole and half as long.
bool EdgeOracle::are_parts_good(const std::array<DrawnPoint, 3>& corner, const std::array<DrawnPoint, 3>& middle, const FaceParts& parts,
                                FaceJudgement& judgement) const {
  for (const DrawnPoint& m : middle)
    if (m.off > parts.limits.error * m.weight || (!parts.has_depth && m.depth_off > parts.limits.depth_error)) return false;
  if (!is_part_good({middle[1], middle[2], middle[0]}, parts, judgement)) return false;
  for (int k = 0; k < 3; ++k) {
    std::array<DrawnPoint, 3> part;
    part[k] = corner[k];
    part[(k + 1) % 3] = middle[k];
    part[(k + 2) % 3] = middle[(k + 2) % 3];
    if (!is_part_good(part, parts, judgement)) return false;
  }
  return true;
}

// In the order of their cost: the bounds of what it is a part of, its own, those of its sides, and those of its parts.
bool EdgeOracle::is_part_good(const std::array<DrawnPoint, 3>& corner, FaceParts parts, FaceJudgement& judgement) const {
  const Vec3 weights(corner[0].weight, corner[1].weight, corner[2].weight);
  const double least = lowest_of(weights);
  const Vec3 at = Vec3(corner[0].off, corner[1].off, corner[2].off) / least;
  const auto is_enough = [&](const Vec3& bounds) { return peak_face(at, bounds / (8 * least)) <= parts.limits.error; };
  if (parts.has_depth && is_enough(parts.seconds)) return true;
  const FaceBend bend = bound_.face({&corner[0], &corner[1], &corner[2]}, weights, !parts.has_depth);
  if (!parts.has_depth) {
    const double depth_error = peak_depth(Vec3(corner[0].depth_off, corner[1].depth_off, corner[2].depth_off), bend.depth);
    parts.has_depth = depth_error <= parts.limits.depth_error;
    if (parts.has_depth) judgement.depth_error = std::max(judgement.depth_error, depth_error);
  }
  const Vec3 own = glm::min(parts.seconds, bend.second);
  if (parts.has_depth && is_enough(own)) return true;
  const int k = lowest(own);
  Vec3 sharper = own;
  for (const int i : {(k + 1) % 3, (k + 2) % 3}) {
    const DrawnPoint &p = corner[i], &q = corner[(i + 1) % 3];
    sharper[i] = std::min(own[i], bound_.edge(p, q, p.weight, q.weight).second);
  }
  if (parts.has_depth && is_enough(sharper)) return true;
  if (parts.depth == 1) return false;
  std::array<DrawnPoint, 3> middle;
  for (int i = 0; i < 3; ++i) middle[i] = between(corner[i], corner[(i + 1) % 3]);
  judgement.evaluations += 3;
  return are_parts_good(corner, middle, {0.25 * own, parts.depth - 1, parts.has_depth, parts.limits}, judgement);
}

double EdgeOracle::interior_error(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& weights) const {
  const Vec3 drawn = homogeneous(a.mapped) * weights.x + homogeneous(b.mapped) * weights.y + homogeneous(c.mapped) * weights.z;
  const Mapped exact = map_point(a.eye * weights.x + b.eye * weights.y + c.eye * weights.z);
  return glm::length(dehomogenise(drawn) - exact.image);
}

double EdgeOracle::interior_depth_error(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& weights) const {
  const Vec3 eye = a.eye * weights.x + b.eye * weights.y + c.eye * weights.z;
  const bool is_perspective = options_.projection == Projection::perspective;
  const Vec3 corner = is_perspective ? Vec3(a.mapped.weight, b.mapped.weight, c.mapped.weight) : Vec3(a.rho, b.rho, c.rho);
  return std::abs(glm::dot(corner, weights) / (is_perspective ? map_point(eye).weight : glm::length(eye)) - 1);
}

} // namespace domewarp
