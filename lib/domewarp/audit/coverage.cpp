// SPDX-License-Identifier: GPL-3.0-or-later
// In source space the warped triangles must tile the source's triangles: no silhouette and no depth order blurs that.
#include "domewarp/audit/coverage.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace domewarp {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using TreePrimitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, TreePrimitive>>;

constexpr double boundary_margin = 1e-4; ///< samples nearer to what clips are not asked
constexpr double edge_margin = 1e-3;     ///< barycentric; samples nearer to an edge are on both its faces

Kernel::Point_3 point(const Vec3& p) { return {p.x, p.y, p.z}; }

double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  if (la == 0 || lb == 0 || lc == 0) return 0;
  const double volume = glm::dot(a, glm::cross(b, c)) / (la * lb * lc); // Van Oosterom and Strackee 1983
  return 2 * std::atan2(std::abs(volume), 1 + glm::dot(a, b) / (la * lb) + glm::dot(b, c) / (lb * lc) + glm::dot(c, a) / (lc * la));
}

/// Barycentric weights of the point of the triangle's plane nearest to p.
Vec3 weights_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 n = glm::cross(b - a, c - a);
  const double area2 = glm::dot(n, n);
  if (area2 == 0) return Vec3(0);
  return Vec3(glm::dot(n, glm::cross(c - b, p - b)), glm::dot(n, glm::cross(a - c, p - c)), glm::dot(n, glm::cross(b - a, p - a))) / area2;
}

/// Triangles with a search tree.
class Located {
public:
  Located(const std::vector<Vec3>& points, std::vector<Corners> triangles) : points_(points), triangles_(std::move(triangles)) {
    for (const Corners& t : triangles_) shapes_.emplace_back(point(points[t[0]]), point(points[t[1]]), point(points[t[2]]));
    tree_.rebuild(shapes_.cbegin(), shapes_.cend());
  }

  /// Indices of the triangles within `reach` of p.
  const std::vector<std::size_t>& at(const Vec3& p, double reach) {
    hits_.clear();
    found_.clear();
    if (tree_.empty()) return found_;
    const CGAL::Bbox_3 box(p.x - reach, p.y - reach, p.z - reach, p.x + reach, p.y + reach, p.z + reach);
    tree_.all_intersected_primitives(box, std::back_inserter(hits_));
    for (const auto& hit : hits_) found_.push_back(static_cast<std::size_t>(hit - shapes_.cbegin()));
    std::sort(found_.begin(), found_.end());
    return found_;
  }

  Vec3 weights(std::size_t triangle, const Vec3& p) const {
    const Corners& t = triangles_[triangle];
    return weights_of(points_[t[0]], points_[t[1]], points_[t[2]], p);
  }

  const Corners& corners(std::size_t triangle) const { return triangles_[triangle]; }

private:
  const std::vector<Vec3>& points_;
  std::vector<Corners> triangles_;
  Triangles shapes_;
  Tree tree_;
  std::vector<Triangles::const_iterator> hits_;
  std::vector<std::size_t> found_;
};

bool is_inside(const Vec3& weights) { return std::min({weights.x, weights.y, weights.z}) > edge_margin; }

class CoverageMeasure {
public:
  CoverageMeasure(const Drawn& drawn, const Provenance& provenance, const Picture& picture, const SourceMesh& source)
      : drawn_(drawn), provenance_(provenance), picture_(picture), source_(source),
        warped_(provenance.source, drawn.triangles), seen_(source.points, seen_triangles(source)),
        reach_(provenance.exact ? 0x1p-21 : 2e-5) {}

  CoverageReport run(std::size_t budget) {
    std::vector<double> angles;
    double total = 0;
    for (std::size_t f = 0; f < source_.triangles.size(); ++f) {
      const Corners& t = source_.triangles[f];
      angles.push_back(source_.is_back[f] ? 0 : solid_angle(source_.points[t[0]], source_.points[t[1]], source_.points[t[2]]));
      total += angles.back();
    }
    // Half the budget by count, half by solid angle; a scene with more triangles than that has every n-th asked.
    const std::size_t step = 1 + 2 * angles.size() / std::max<std::size_t>(budget, 1);
    for (std::size_t f = 0; f < angles.size(); ++f) {
      if (source_.is_back[f]) continue;
      const auto count = static_cast<std::size_t>(f % step == 0) + (total > 0 ? static_cast<std::size_t>(0.5 * static_cast<double>(budget) * angles[f] / total) : 0);
      for (std::size_t i = 0; i < count; ++i) sample(f, i, angles[f] / static_cast<double>(count));
    }
    if (measured_ > 0) report_.error_px_mean = sum_ / static_cast<double>(measured_);
    return report_;
  }

private:
  static std::vector<Corners> seen_triangles(const SourceMesh& source) {
    std::vector<Corners> seen;
    for (std::size_t f = 0; f < source.triangles.size(); ++f)
      if (!source.is_back[f]) seen.push_back(source.triangles[f]);
    return seen;
  }

  /// The i-th point of the triangle's R2 sequence (Roberts 2018), folded into the triangle.
  Vec3 point_of(std::size_t face, std::size_t i) const {
    const double n = static_cast<double>(i) + 0.6180339887498949 * static_cast<double>(face % 1024);
    double u = 0.5 + 0.7548776662466927 * n, v = 0.5 + 0.5698402909980532 * n;
    u -= std::floor(u);
    v -= std::floor(v);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Corners& t = source_.triangles[face];
    return source_.points[t[0]] * (1 - u - v) + source_.points[t[1]] * u + source_.points[t[2]] * v;
  }

  void sample(std::size_t face, std::size_t i, double angle) {
    const Vec3 p = point_of(face, i);
    std::vector<std::size_t> expected; // branches
    for (std::size_t b = 0; b < picture_.surface.branches().size(); ++b) {
      if (is_shown(picture_, b, p, boundary_margin) && !is_near_rim(picture_, b, p)) expected.push_back(b);
      else if (is_shown(picture_, b, p, -boundary_margin)) return;
    }
    if (expected.empty()) return;
    ++report_.samples;
    const double reach = reach_ * glm::length(p);
    std::size_t inside_source = 0, inside = 0;
    bool near_edge = false;
    for (const std::size_t t : seen_.at(p, reach)) {
      inside_source += is_inside(seen_.weights(t, p));
      near_edge = near_edge || !is_inside(seen_.weights(t, p));
    }
    std::size_t hits = 0;
    for (const std::size_t t : warped_.at(p, reach)) {
      const Corners& corners = warped_.corners(t);
      const std::size_t branch = provenance_.branch[corners[0]];
      if (std::find(expected.begin(), expected.end(), branch) == expected.end() && is_clipped(corners, branch)) continue;
      ++hits;
      const Vec3 weights = warped_.weights(t, p);
      near_edge = near_edge || !is_inside(weights);
      if (!is_inside(weights)) continue;
      ++inside;
      measure_error(t, weights, p);
    }
    if (hits < expected.size()) {
      ++report_.lost;
      report_.lost_area_px2 += angle * pixels_per_steradian(picture_, expected.front(), p);
    }
    report_.overlapping += !near_edge && inside > inside_source * expected.size();
  }

  /// Whether the branch shows the directions of all corners. A triangle that shows what the branch does not then does so
  /// beside the picture, or because the chords of a rim are straight in space.
  bool is_clipped(const Corners& corners, std::size_t branch) const {
    return std::all_of(corners.begin(), corners.end(), [&](std::size_t v) {
      return inside_angles(picture_.map.branches[branch].branch(), provenance_.source[v]) >= -boundary_margin;
    });
  }

  void measure_error(std::size_t triangle, const Vec3& weights, const Vec3& p) {
    const Corners& t = warped_.corners(triangle);
    const Vec3 drawn = drawn_.position[t[0]] * weights.x + drawn_.position[t[1]] * weights.y + drawn_.position[t[2]] * weights.z;
    const Vec2 image = picture_.map.branches[provenance_.branch[t[0]]].image(p);
    const double error = glm::length(drawn_at(drawn, picture_.perspective) - image) / pixel_size(picture_.raster);
    report_.error_px_max = std::max(report_.error_px_max, error);
    sum_ += error;
    ++measured_;
  }

  const Drawn& drawn_;
  const Provenance& provenance_;
  const Picture& picture_;
  const SourceMesh& source_;
  Located warped_, seen_;
  double reach_;
  double sum_ = 0;
  std::size_t measured_ = 0;
  CoverageReport report_;
};

} // namespace

CoverageReport measure_coverage(const Drawn& drawn, const Provenance& provenance, const Picture& picture, const SourceMesh& source,
                                std::size_t budget) {
  return CoverageMeasure(drawn, provenance, picture, source).run(budget);
}

} // namespace domewarp
