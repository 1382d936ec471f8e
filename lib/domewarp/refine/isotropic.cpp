// SPDX-License-Identifier: Apache-2.0
// Based on: S. Deak, thesis 2001, section 3.3.3 (DivideRecurse). Its errata 9 (triangles lost), 10 (extreme values), 12
// and 13 (what is counted) and 17 (length is no error) are kept on purpose; only the criterion's unit is ours.
#include "domewarp/refine/isotropic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/transform/polar.h"

namespace domewarp {

namespace {

constexpr std::size_t block_size = 256;
constexpr double extreme_radius = 1000; ///< image radius of blind points, "well outside r_max"

struct Corner {
  std::uint32_t point = 0, wedge = 0;
};
using Corners = std::array<Corner, 3>;

/// The transformation of points, as the thesis does it.
class PointTransform {
public:
  PointTransform(const Surface& surface, const ImageMap& map, Projection projection)
      : surface_(surface), map_(map), projection_(projection) {}

  MappedPoint operator()(const Vec3& eye) const {
    const ImagePoint image = project(surface_, map_, eye);
    MappedPoint point{direction_of(eye), {1, 1, 1}, {{image.x, image.y}, 1}};
    if (image.state != PointState::visible) point.sides.fill(-1);
    if (image.state == PointState::blind) point.mapped.image = extreme_radius * side(polar(eye));
    if (projection_ == Projection::perspective) point.mapped.weight = weight(eye);
    return point;
  }

private:
  double weight(const Vec3& eye) const {
    if (eye == Vec3(0)) return 0;
    const auto shows = [&](const BranchMap& branch) {
      const Vec2 within = branch.inside(eye);
      return within.x >= 0 && within.y >= 0;
    };
    const auto found = std::find_if(map_.branches.begin(), map_.branches.end(), shows);
    return glm::length(eye) * (found == map_.branches.end() ? map_.branches.back() : *found).factors(eye).g;
  }

  const Surface& surface_;
  const ImageMap& map_;
  Projection projection_;
};

/// What a run of source triangles turns into. Ids from `first_point` and `first_wedge` on count its own points and wedges.
class Recursion {
public:
  Recursion(const Soup& soup, const std::vector<MappedPoint>& base, const PointTransform& transform,
            const IsotropicOptions& options, std::size_t max_faces)
      : soup_(soup), base_(base), transform_(transform), options_(options), max_faces_(max_faces) {}

  void run(std::uint32_t source) {
    source_ = source;
    const SoupFace& face = soup_.faces[source];
    const Triangle point = points_of(soup_, face);
    divide({Corner{point[0], face.wedge[0]}, Corner{point[1], face.wedge[1]}, Corner{point[2], face.wedge[2]}}, 0);
  }

  /// Appends to what earlier blocks have made.
  void move_to(RefinedMesh& mesh, IsotropicReport& report) {
    const auto points_before = static_cast<std::uint32_t>(mesh.points.size() - base_.size());
    const auto wedges_before = static_cast<std::uint32_t>(mesh.wedges.size());
    const auto shift = [](std::uint32_t& id, std::size_t own_from, std::uint32_t by) {
      if (id >= own_from) id += by;
    };
    for (Wedge& wedge : wedges_) {
      for (std::uint32_t& parent : wedge.parent) shift(parent, soup_.wedge_point.size(), wedges_before);
      shift(wedge.point, base_.size(), points_before);
    }
    for (RefinedFace& face : faces_)
      for (int k = 0; k < 3; ++k) {
        shift(face.point[k], base_.size(), points_before);
        shift(face.wedge[k], soup_.wedge_point.size(), wedges_before);
      }
    mesh.points.insert(mesh.points.end(), points_.begin(), points_.end());
    mesh.wedges.insert(mesh.wedges.end(), wedges_.begin(), wedges_.end());
    mesh.faces.insert(mesh.faces.end(), faces_.begin(), faces_.end());
    mesh.levels = std::max(mesh.levels, deepest_);
    report.divisions += divisions_;
    report.invisible += invisible_;
    report.stopped = report.stopped || stopped_;
  }

private:
  void divide(const Corners& base, int lod) {
    if (std::all_of(base.begin(), base.end(), [&](const Corner& c) { return point(c).sides[0] < 0; })) {
      ++invisible_;
      return;
    }
    stopped_ = stopped_ || faces_.size() >= max_faces_;
    if (stopped_ || lod >= options_.max_lod || !(longest_edge(base) > options_.threshold)) {
      faces_.push_back({{base[0].point, base[1].point, base[2].point}, {base[0].wedge, base[1].wedge, base[2].wedge}, {}, source_});
      return;
    }
    ++divisions_;
    deepest_ = std::max(deepest_, static_cast<std::size_t>(lod) + 1);
    const Corners middle{bisect(base[0], base[1]), bisect(base[1], base[2]), bisect(base[2], base[0])};
    divide({base[0], middle[0], middle[2]}, lod + 1);
    divide({middle[0], base[1], middle[1]}, lod + 1);
    divide({middle[2], middle[1], base[2]}, lod + 1);
    divide({middle[0], middle[1], middle[2]}, lod + 1);
  }

  const MappedPoint& point(const Corner& corner) const {
    return corner.point < base_.size() ? base_[corner.point] : points_[corner.point - base_.size()];
  }

  double longest_edge(const Corners& base) const {
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, glm::length(point(base[k]).mapped.image - point(base[(k + 1) % 3]).mapped.image));
    return longest;
  }

  Corner bisect(const Corner& a, const Corner& b) {
    const Corner middle{static_cast<std::uint32_t>(base_.size() + points_.size()),
                        static_cast<std::uint32_t>(soup_.wedge_point.size() + wedges_.size())};
    points_.push_back(transform_(0.5 * (point(a).eye + point(b).eye)));
    wedges_.push_back({{a.wedge, b.wedge, a.wedge}, {0.5, 0.5, 0}, middle.point, soup_.faces[source_].part});
    return middle;
  }

  const Soup& soup_;
  const std::vector<MappedPoint>& base_;
  const PointTransform& transform_;
  const IsotropicOptions& options_;
  std::size_t max_faces_;
  std::uint32_t source_ = 0;
  std::vector<MappedPoint> points_;
  std::vector<Wedge> wedges_;
  std::vector<RefinedFace> faces_;
  std::size_t divisions_ = 0, invisible_ = 0, deepest_ = 0;
  bool stopped_ = false;
};

} // namespace

RefinedMesh subdivide_isotropic(const Soup& soup, const Surface& surface, const ImageMap& map, Projection projection,
                                const IsotropicOptions& options, std::size_t max_triangles, IsotropicReport& report) {
  const PointTransform transform(surface, map, projection);
  std::vector<MappedPoint> base(soup.points.size());
  parallel_each(base.size(), 4096, [&](std::size_t i) { base[i] = transform(soup.points[i]); });
  RefinedMesh mesh;
  mesh.points.assign(base.begin(), base.end());
  const std::size_t blocks = (soup.faces.size() + block_size - 1) / block_size;
  std::vector<Recursion> recursions(blocks, Recursion(soup, base, transform, options, max_triangles / std::max<std::size_t>(blocks, 1) + 1));
  parallel_each(blocks, 1, [&](std::size_t block) {
    const std::size_t end = std::min(soup.faces.size(), (block + 1) * block_size);
    for (std::size_t f = block * block_size; f < end; ++f) recursions[block].run(static_cast<std::uint32_t>(f));
  });
  for (Recursion& recursion : recursions) recursion.move_to(mesh, report);
  report.points = 3 * soup.source_triangles + 12 * report.divisions;
  report.points_computed = 3 * soup.source_triangles + 3 * report.divisions;
  mesh.evaluations = base.size() + 3 * report.divisions;
  return mesh;
}

} // namespace domewarp
