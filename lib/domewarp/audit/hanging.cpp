// SPDX-License-Identifier: GPL-3.0-or-later
#include "domewarp/audit/hanging.h"

#include <algorithm>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

namespace domewarp {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

Point point(const Vec3& p) { return {p.x, p.y, p.z}; }

Box padded_box(const Vec3& a, const Vec3& b, double padding, std::uint32_t id) {
  CGAL::Bbox_3 box = point(a).bbox() + point(b).bbox();
  box = CGAL::Bbox_3(box.xmin() - padding, box.ymin() - padding, box.zmin() - padding, box.xmax() + padding,
                     box.ymax() + padding, box.zmax() + padding);
  return Box(box, id);
}

} // namespace

bool are_collinear(const Vec3& a, const Vec3& b, const Vec3& c) { return CGAL::collinear(point(a), point(b), point(c)); }

std::vector<HangingVertex> find_hanging_vertices(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 2>> edges,
                                                 std::span<const std::uint32_t> vertices, double tolerance) {
  std::vector<Box> edge_boxes, vertex_boxes;
  for (std::uint32_t e = 0; e < edges.size(); ++e)
    edge_boxes.push_back(padded_box(points[edges[e][0]], points[edges[e][1]], tolerance, e));
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    vertex_boxes.push_back(padded_box(points[vertices[v]], points[vertices[v]], 0, v));
  std::vector<HangingVertex> found;
  const auto visit = [&](const Box& edge_box, const Box& vertex_box) {
    const std::uint32_t e = edge_box.info(), v = vertex_box.info(), id = vertices[v];
    if (id == edges[e][0] || id == edges[e][1]) return;
    const Point a = point(points[edges[e][0]]), b = point(points[edges[e][1]]), p = point(points[id]);
    const double length2 = CGAL::squared_distance(a, b);
    const double t = (p - a) * (b - a) / length2;
    const double margin = tolerance / std::sqrt(length2);
    if (t <= margin || t >= 1 - margin) return;
    const bool near = CGAL::squared_distance(p, Kernel::Segment_3(a, b)) <= tolerance * tolerance;
    if (near || CGAL::collinear(a, p, b)) found.push_back({e, v, t});
  };
  CGAL::box_intersection_d(edge_boxes.begin(), edge_boxes.end(), vertex_boxes.begin(), vertex_boxes.end(), visit);
  std::sort(found.begin(), found.end(), [](const HangingVertex& x, const HangingVertex& y) {
    return x.edge != y.edge ? x.edge < y.edge : x.vertex < y.vertex;
  });
  return found;
}

} // namespace domewarp
