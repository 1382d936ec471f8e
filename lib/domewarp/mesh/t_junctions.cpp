// SPDX-License-Identifier: Apache-2.0
#include "domewarp/mesh/t_junctions.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/point_tree.h"

namespace domewarp {

namespace {

std::vector<std::uint32_t> ends_of_open_edges(const MeshTopology& topology) {
  std::vector<std::uint32_t> ids;
  for (const MeshTopology::Edge& edge : topology.edges)
    if (edge.faces == 1) ids.insert(ids.end(), {edge.a, edge.b});
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

double largest(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

void find_on_edge(const PointTree& candidates, const MeshTopology::Edge& edge, std::uint32_t index, double tolerance,
                  std::vector<TJunction>& found) {
  const std::span<const Vec3> points = candidates.points();
  const Vec3 a = points[edge.a], b = points[edge.b], d = b - a;
  const double length = glm::length(d);
  const double reach = tolerance * length + std::ldexp(std::max(largest(a), largest(b)), -21); // four units in the last place
  if (length <= 8 * reach) return; // nowhere is far enough from both ends
  candidates.visit_near_segment(a, b, reach, [&](std::uint32_t id) {
    if (id == edge.a || id == edge.b) return true;
    const double t = glm::dot(points[id] - a, d) / (length * length);
    if (t * length <= 4 * reach || (1 - t) * length <= 4 * reach) return true;
    if (glm::length(points[id] - (a + t * d)) <= reach) found.push_back({index, id, t});
    return true;
  });
}

} // namespace

std::vector<TJunction> find_t_junctions(std::span<const Vec3> points, const MeshTopology& topology, double tolerance) {
  const PointTree candidates(points, ends_of_open_edges(topology));
  constexpr std::size_t block_size = 128;
  std::vector<std::vector<TJunction>> blocks((topology.edges.size() + block_size - 1) / block_size);
  parallel_each(blocks.size(), 1, [&](std::size_t block) {
    const std::size_t end = std::min(topology.edges.size(), (block + 1) * block_size);
    for (std::size_t e = block * block_size; e < end; ++e)
      if (topology.edges[e].faces == 1) find_on_edge(candidates, topology.edges[e], static_cast<std::uint32_t>(e), tolerance, blocks[block]);
  });
  std::vector<TJunction> found;
  for (const auto& block : blocks) found.insert(found.end(), block.begin(), block.end());
  std::sort(found.begin(), found.end(),
            [](const TJunction& x, const TJunction& y) { return std::tuple(x.edge, x.t, x.point) < std::tuple(y.edge, y.t, y.point); });
  return found;
}

std::size_t count_near_misses(std::span<const Vec3> points, const MeshTopology& topology, double offset) {
  const auto reach = [&](const Vec3& p) { return std::ldexp(largest(p) + offset, -20); };
  return count_near_pairs(PointTree(points, ends_of_open_edges(topology)), reach);
}

} // namespace domewarp
