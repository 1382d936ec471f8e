// SPDX-License-Identifier: Apache-2.0
#include "domewarp/mesh/t_junctions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace domewarp {

namespace {

/// Points sorted along the longest axis of their box: a range of it holds every candidate for one edge. Open edges are
/// few in real scenes, so one sorted axis is enough (a grid measured no faster on the sample scenes).
class SortedPoints {
public:
  SortedPoints(std::span<const Vec3> points, std::vector<std::uint32_t> ids) : points_(points), ids_(std::move(ids)) {
    Vec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const std::uint32_t id : ids_) {
      low = glm::min(low, points_[id]);
      high = glm::max(high, points_[id]);
    }
    const Vec3 extent = high - low;
    axis_ = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::sort(ids_.begin(), ids_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(points_[a][axis_], a) < std::tuple(points_[b][axis_], b);
    });
  }

  template <typename Visit>
  void visit(const Vec3& low, const Vec3& high, Visit&& visit) const {
    auto it = std::lower_bound(ids_.begin(), ids_.end(), low[axis_],
                               [&](std::uint32_t id, double value) { return points_[id][axis_] < value; });
    for (; it != ids_.end() && points_[*it][axis_] <= high[axis_]; ++it) {
      const Vec3& p = points_[*it];
      if (p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z) visit(*it);
    }
  }

private:
  std::span<const Vec3> points_;
  std::vector<std::uint32_t> ids_;
  int axis_ = 0;
};

std::vector<std::uint32_t> ends_of_open_edges(const MeshTopology& topology) {
  std::vector<std::uint32_t> ids;
  for (const MeshTopology::Edge& edge : topology.edges)
    if (edge.faces == 1) ids.insert(ids.end(), {edge.a, edge.b});
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

double largest(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

} // namespace

std::vector<TJunction> find_t_junctions(std::span<const Vec3> points, const MeshTopology& topology, double tolerance) {
  const SortedPoints candidates(points, ends_of_open_edges(topology));
  std::vector<TJunction> found;
  for (std::uint32_t e = 0; e < topology.edges.size(); ++e) {
    const MeshTopology::Edge& edge = topology.edges[e];
    if (edge.faces != 1) continue;
    const Vec3 a = points[edge.a], b = points[edge.b], d = b - a;
    const double length = glm::length(d);
    const double reach = tolerance * length + std::ldexp(std::max(largest(a), largest(b)), -23);
    candidates.visit(glm::min(a, b) - Vec3(reach), glm::max(a, b) + Vec3(reach), [&](std::uint32_t id) {
      if (id == edge.a || id == edge.b) return;
      const double t = glm::dot(points[id] - a, d) / (length * length);
      if (t * length <= 4 * reach || (1 - t) * length <= 4 * reach) return;
      if (glm::length(points[id] - (a + t * d)) <= reach) found.push_back({e, id, t});
    });
  }
  std::sort(found.begin(), found.end(),
            [](const TJunction& x, const TJunction& y) { return std::tuple(x.edge, x.t, x.point) < std::tuple(y.edge, y.t, y.point); });
  return found;
}

} // namespace domewarp
