// SPDX-License-Identifier: GPL-3.0-or-later
#include "domewarp/audit/hanging.h"

#include <algorithm>
#include <tuple>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

namespace domewarp {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using IndexedBox = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

Point point(const Vec3& p) { return {p.x, p.y, p.z}; }

IndexedBox padded_box(const Vec3& a, const Vec3& b, double padding, std::uint32_t id) {
  CGAL::Bbox_3 box = point(a).bbox() + point(b).bbox();
  box = CGAL::Bbox_3(box.xmin() - padding, box.ymin() - padding, box.zmin() - padding, box.xmax() + padding,
                     box.ymax() + padding, box.zmax() + padding);
  return IndexedBox(box, id);
}

} // namespace

bool are_collinear(const Vec3& a, const Vec3& b, const Vec3& c) { return CGAL::collinear(point(a), point(b), point(c)); }

int turn_from_origin(const Vec3& a, const Vec3& b, const Vec3& c) {
  return static_cast<int>(CGAL::orientation(Point(0, 0, 0), point(a), point(b), point(c)));
}

int turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return static_cast<int>(CGAL::orientation(Kernel::Point_2(a.x, a.y), Kernel::Point_2(b.x, b.y), Kernel::Point_2(c.x, c.y)));
}

std::vector<HangingVertex> find_hanging_vertices(std::span<const Vec3> points, std::span<const Ends> edges,
                                                 std::span<const std::uint32_t> vertices,
                                                 const std::function<double(const Vec3&, const Vec3&)>& tolerance) {
  std::vector<IndexedBox> edge_boxes, vertex_boxes;
  std::vector<double> tolerances;
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const Vec3& a = points[edges[e][0]];
    const Vec3& b = points[edges[e][1]];
    tolerances.push_back(tolerance(a, b));
    edge_boxes.push_back(padded_box(a, b, tolerances.back(), e));
  }
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    vertex_boxes.push_back(padded_box(points[vertices[v]], points[vertices[v]], 0, v));
  std::vector<HangingVertex> found;
  const auto visit = [&](const IndexedBox& edge_box, const IndexedBox& vertex_box) {
    const std::uint32_t e = edge_box.info(), v = vertex_box.info(), id = vertices[v];
    if (id == edges[e][0] || id == edges[e][1]) return;
    const Point a = point(points[edges[e][0]]), b = point(points[edges[e][1]]), p = point(points[id]);
    const double length2 = CGAL::squared_distance(a, b);
    const double t = (p - a) * (b - a) / length2;
    const double margin = tolerances[e] / std::sqrt(length2);
    if (!(t > margin && t < 1 - margin)) return;
    const bool near = CGAL::squared_distance(p, Kernel::Segment_3(a, b)) <= tolerances[e] * tolerances[e];
    if (near || CGAL::collinear(a, p, b)) found.push_back({e, v, t});
  };
  CGAL::box_intersection_d(edge_boxes.begin(), edge_boxes.end(), vertex_boxes.begin(), vertex_boxes.end(), visit);
  std::sort(found.begin(), found.end(), [](const HangingVertex& x, const HangingVertex& y) {
    return std::tuple(x.edge, x.t, x.vertex) < std::tuple(y.edge, y.t, y.vertex);
  });
  return found;
}

} // namespace domewarp
