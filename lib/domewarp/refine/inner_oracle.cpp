// SPDX-License-Identifier: Apache-2.0
// The part of the oracle that lets what a face shows slide inside its outline.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "domewarp/refine/edge_oracle.h"

namespace domewarp {

namespace {

/// A face whose sine is smaller has a normal of rounding.
constexpr double thinnest = 1e-6;

} // namespace

std::optional<InnerPlane> EdgeOracle::inner_plane(const Vec3& a, const Vec3& b, const Vec3& c, bool is_plain) const {
  const double tolerance = std::max(options_.texture_tolerance, is_plain ? options_.plain_tolerance : 0);
  if (!(tolerance > options_.tolerance)) return std::nullopt;
  const Vec3 u = b - a, v = c - a, w = c - b, normal = glm::cross(u, v);
  const double size = glm::length(normal);
  if (!(size > thinnest * std::max({glm::dot(u, u), glm::dot(v, v), glm::dot(w, w)}))) return std::nullopt;
  // Rounding moves the plane by a few units of the farthest corner: a little nearer is on the safe side.
  const double farthest = std::sqrt(std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)}));
  const double distance = std::abs(glm::dot(normal, a)) / size - 1e-15 / thinnest * farthest;
  if (!(distance > 0)) return std::nullopt;
  return InnerPlane{tolerance, distance};
}

double EdgeOracle::slid_depth(const Range& span, double farthest, double error, double depth_error, const InnerPlane& inside) const {
  return (1 + depth_error) * (1 + bound_.slide_depth(span, farthest, inside.distance, error)) - 1;
}

bool EdgeOracle::may_slide(const std::array<const MappedPoint*, 3>& corner, const std::array<SideBound, 3>& side, const InnerPlane& inside, int depth,
                           FaceJudgement& judgement) const {
  const SortedFace face = bound_of(corner, side);
  if (face.error > inside.tolerance) return false;
  const Range span = bound_.face_span(*face.corner[0], *face.corner[1], *face.corner[2]);
  const double farthest = std::max({corner[0]->rho, corner[1]->rho, corner[2]->rho});
  const double slide = bound_.slide_depth(span, farthest, inside.distance, face.error);
  const double allowed = (1 + options_.face_depth_tolerance) / (1 + slide) - 1;
  FaceJudgement interpolated;
  if (!(allowed > 0) || !is_within(face, {std::numeric_limits<double>::infinity(), allowed}, depth, interpolated)) return false;
  judgement.evaluations += interpolated.evaluations;
  judgement.depth_error = std::max(judgement.depth_error, (1 + interpolated.depth_error) * (1 + slide) - 1);
  return true;
}

} // namespace domewarp
