// SPDX-License-Identifier: GPL-3.0-or-later
#include "domewarp/audit/cracks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "domewarp/audit/hanging.h"

namespace domewarp {

namespace {

constexpr double negligible_px = 1e-3;

double largest(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// How far rounding moves the points of an edge: float32, or what mapping back loses.
class Rounding {
public:
  explicit Rounding(bool exact) : relative_(exact ? 0x1p-21 : 8e-6) {}
  double operator()(const Vec3& a, const Vec3& b) const { return relative_ * std::max(largest(a), largest(b)); }
  double relative() const { return relative_; }

private:
  double relative_;
};

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double length2 = glm::dot(d, d);
  const double t = length2 > 0 ? glm::clamp(glm::dot(p - a, d) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - (a + t * d));
}

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

class CrackFinder {
public:
  CrackFinder(const Drawn& drawn, const Provenance& provenance, bool perspective, int height, const Picture* picture)
      : drawn_(drawn), provenance_(provenance), perspective_(perspective), pixels_per_unit_(0.5 * height), picture_(picture),
        rounding_(provenance.exact) {
    std::size_t distinct = 0;
    first_drawn_ = first_equal(drawn.position, provenance.branch, distinct);
  }

  CrackReport run(const SourceMesh* source) {
    report_.exact_provenance = provenance_.exact;
    report_.source_known = source != nullptr;
    if (provenance_.exact) find_torn();
    std::vector<Ends> open = use_edges(joined_triangles()).open;
    std::erase_if(open, [&](const Ends& edge) { return is_off_picture(edge); });
    find_t_junctions(open);
    std::erase_if(open, [&](const Ends& edge) { return is_rim(edge); });
    report_.open_edges = open.size() - (source != nullptr ? count_open_in(*source, open) : 0);
    for (const Corners& t : drawn_.triangles) report_.flips += is_flipped(t);
    return report_;
  }

private:
  Vec2 pixel(std::uint32_t v) const { return drawn_at(drawn_.position[v], perspective_) * pixels_per_unit_; }
  const Vec3& source(std::uint32_t v) const { return provenance_.source[v]; }

  /// With those that rounding has collapsed to a line: their neighbours meet there.
  std::vector<Corners> joined_triangles() const {
    std::vector<Corners> joined;
    for (const Corners& t : drawn_.triangles) joined.push_back({first_drawn_[t[0]], first_drawn_[t[1]], first_drawn_[t[2]]});
    return joined;
  }

  void find_torn() {
    std::size_t distinct = 0;
    const std::vector<std::uint32_t> first = first_equal(provenance_.source, provenance_.branch, distinct);
    std::vector<std::uint8_t> torn(first.size(), 0);
    for (std::uint32_t v = 0; v < first.size(); ++v) {
      if (drawn_.position[v] == drawn_.position[first[v]] || is_shared_by_branches(v)) continue;
      const double gap = glm::length(pixel(v) - pixel(first[v]));
      if (gap <= negligible_px) continue; // different points whose float32 source positions are equal
      torn[first[v]] = 1;
      report_.max_gap_px = std::max(report_.max_gap_px, gap);
    }
    report_.torn_positions = static_cast<std::size_t>(std::count(torn.begin(), torn.end(), 1));
  }

  /// Where two branches meet, a position belongs to both.
  bool is_shared_by_branches(std::uint32_t v) const {
    return picture_ != nullptr && picture_->surface.branches().size() > 1 &&
           is_at_boundary(*picture_, provenance_.branch[v], source(v), 4 * rounding_.relative());
  }

  /// Beyond one side of the picture, where faces may have been left out.
  bool is_off_picture(const Ends& edge) const {
    if (picture_ == nullptr) return false;
    const Vec2 half = Vec2(aspect(picture_->raster), 1) * pixels_per_unit_, a = pixel(edge[0]), b = pixel(edge[1]);
    for (int axis = 0; axis < 2; ++axis)
      if (std::min(a[axis], b[axis]) > half[axis] || std::max(a[axis], b[axis]) < -half[axis]) return true;
    return false;
  }

  bool is_rim(const Ends& edge) const {
    return picture_ != nullptr && std::all_of(edge.begin(), edge.end(), [&](std::uint32_t v) {
             return is_at_boundary(*picture_, provenance_.branch[v], source(v), 4 * rounding_.relative()) ||
                    is_near_rim(*picture_, provenance_.branch[v], source(v));
           });
  }

  void find_t_junctions(const std::vector<Ends>& open) {
    const std::vector<std::uint32_t> vertices = ends_of(open);
    const std::vector<HangingVertex> hanging = find_hanging_vertices(provenance_.source, open, vertices, rounding_);
    double sum = 0;
    for (auto it = hanging.begin(); it != hanging.end();) {
      const Ends& edge = open[it->edge];
      std::vector<std::uint32_t> chain{edge[0]};
      const std::uint32_t same = it->edge;
      for (; it != hanging.end() && it->edge == same; ++it)
        if (provenance_.branch[vertices[it->vertex]] == provenance_.branch[edge[0]]) chain.push_back(vertices[it->vertex]);
      for (std::size_t i = 1; i < chain.size(); ++i) {
        const double gap = distance_to_segment(pixel(chain[i]), pixel(edge[0]), pixel(edge[1]));
        if (gap <= negligible_px) continue;
        ++report_.t_junctions;
        report_.max_gap_px = std::max(report_.max_gap_px, gap);
        sum += gap;
      }
      chain.push_back(edge[1]);
      double area = 0;
      for (std::size_t i = 1; i + 1 < chain.size(); ++i) area += twice_area(pixel(chain[0]), pixel(chain[i]), pixel(chain[i + 1]));
      report_.gap_area_px2 += std::abs(area) / 2;
    }
    if (report_.t_junctions > 0) report_.mean_gap_px = sum / static_cast<double>(report_.t_junctions);
  }

  /// How many of these edges lie on edges that are open in the source.
  std::size_t count_open_in(const SourceMesh& mesh, const std::vector<Ends>& open) const {
    std::vector<Vec3> points = mesh.points;
    std::vector<std::uint32_t> middles;
    for (const Ends& edge : open) {
      middles.push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back(0.5 * (source(edge[0]) + source(edge[1])));
    }
    const auto reach = [&](const Vec3& a, const Vec3& b) { return 2 * rounding_(a, b); };
    std::vector<std::uint8_t> found(open.size(), 0);
    for (const HangingVertex& hanging : find_hanging_vertices(points, mesh.open, middles, reach)) {
      const Vec3 a = points[mesh.open[hanging.edge][0]], b = points[mesh.open[hanging.edge][1]];
      const Ends& edge = open[hanging.vertex];
      const auto is_on = [&](const Vec3& p) {
        const double t = glm::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
        return glm::length(p - (a + t * (b - a))) <= 2 * reach(a, b);
      };
      if (is_on(source(edge[0])) && is_on(source(edge[1]))) found[hanging.vertex] = 1;
    }
    return static_cast<std::size_t>(std::count(found.begin(), found.end(), 1));
  }

  /// The sign of the image's area must be that of the source seen from the eye, times the branch's orientation.
  bool is_flipped(const Corners& t) const {
    const Vec3 a = source(t[0]), b = source(t[1]), c = source(t[2]);
    const double volume = glm::dot(a, glm::cross(b - a, c - a)), size = std::max({largest(a), largest(b), largest(c)});
    if (std::abs(volume) <= 8 * rounding_.relative() * size * size * (largest(b - a) + largest(c - a))) return false; // edge-on
    const int drawn = perspective_ ? turn_from_origin(drawn_.position[t[0]], drawn_.position[t[1]], drawn_.position[t[2]])
                                   : -turn(Vec2(drawn_.position[t[0]]), Vec2(drawn_.position[t[1]]), Vec2(drawn_.position[t[2]]));
    const int orientation = picture_ == nullptr ? 1 : picture_->surface.branches()[provenance_.branch[t[0]]].orientation;
    return drawn != orientation * turn_from_origin(a, b, c) && is_thick(t);
  }

  bool is_thick(const Corners& t) const {
    const Vec2 a = pixel(t[0]), b = pixel(t[1]), c = pixel(t[2]);
    const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
    return std::abs(twice_area(a, b, c)) > negligible_px * longest;
  }

  const Drawn& drawn_;
  const Provenance& provenance_;
  bool perspective_;
  double pixels_per_unit_;
  const Picture* picture_;
  Rounding rounding_;
  std::vector<std::uint32_t> first_drawn_; ///< faces meet where their corners are drawn at one place
  CrackReport report_;
};

} // namespace

SourceMesh make_source_mesh(const Scene& scene, const View& view) {
  Drawn drawn = collect_drawn(scene);
  for (Vec3& p : drawn.position) p = to_eye(view, p) + Vec3(0.0);
  std::size_t distinct = 0;
  const std::vector<std::uint32_t> first = first_equal(drawn.position, {}, distinct);
  SourceMesh mesh;
  std::vector<Corners> front;
  for (std::size_t i = 0; i < drawn.triangles.size(); ++i) {
    const Corners& t = drawn.triangles[i];
    const Corners welded{first[t[0]], first[t[1]], first[t[2]]};
    if (welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0]) continue;
    mesh.triangles.push_back(welded);
    const bool back = drawn.single_sided[i] && turn_from_origin(drawn.position[t[0]], drawn.position[t[1]], drawn.position[t[2]]) > 0;
    mesh.is_back.push_back(back);
    if (!back) front.push_back(welded);
  }
  mesh.points = std::move(drawn.position);
  mesh.open = use_edges(mesh.triangles).open;
  const std::vector<Ends> silhouette = use_edges(front).open;
  mesh.open.insert(mesh.open.end(), silhouette.begin(), silhouette.end());
  std::sort(mesh.open.begin(), mesh.open.end());
  mesh.open.erase(std::unique(mesh.open.begin(), mesh.open.end()), mesh.open.end());
  return mesh;
}

CrackReport find_cracks(const Drawn& drawn, const Provenance& provenance, bool perspective, int height, const Picture* picture,
                        const SourceMesh* source) {
  return CrackFinder(drawn, provenance, perspective, height, picture).run(source);
}

} // namespace domewarp
