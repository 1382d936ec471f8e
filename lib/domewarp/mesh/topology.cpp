// SPDX-License-Identifier: Apache-2.0
// Sides are dealt to their lower point and sorted there: a handful each. Inserting the same faces into OpenMesh's
// half-edge structure took six times as long (340 against 56 ms for 10^6 triangles, one thread) and cannot use two
// threads; it serves where a mesh is walked (half_edges.h).
#include "domewarp/mesh/topology.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

#include "domewarp/core/parallel.h"
#include "domewarp/core/raw_vector.h"

namespace domewarp {

namespace {

constexpr std::size_t grain = 8192;

/// One side of a triangle, kept with its lower point.
struct Side {
  std::uint32_t b = 0;    ///< higher point
  std::uint32_t side = 0; ///< 3 * triangle + corner
  auto operator<=>(const Side&) const = default;
};

std::pair<std::uint32_t, std::uint32_t> ends(const Triangle& t, std::size_t corner) {
  return std::minmax({t[corner], t[(corner + 1) % 3]});
}

/// Sides sorted by lower point, higher point, then triangle; `begin[p]` is the first of lower point p.
struct SortedSides {
  std::vector<std::uint32_t> begin;
  RawVector<Side> sides;
};

SortedSides sort_sides(std::uint32_t point_count, std::span<const Triangle> triangles) {
  SortedSides sorted;
  std::vector<std::atomic<std::uint32_t>> next(point_count);
  parallel_each(triangles.size(), grain, [&](std::size_t f) {
    for (std::size_t k = 0; k < 3; ++k) next[ends(triangles[f], k).first].fetch_add(1, std::memory_order_relaxed);
  });
  sorted.begin.resize(point_count + 1, 0);
  for (std::uint32_t p = 0; p < point_count; ++p) {
    sorted.begin[p + 1] = sorted.begin[p] + next[p].load(std::memory_order_relaxed);
    next[p].store(sorted.begin[p], std::memory_order_relaxed);
  }
  sorted.sides.resize(3 * triangles.size());
  parallel_each(triangles.size(), grain, [&](std::size_t f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = ends(triangles[f], k);
      sorted.sides[next[a].fetch_add(1, std::memory_order_relaxed)] = {b, static_cast<std::uint32_t>(3 * f + k)};
    }
  });
  parallel_each(point_count, grain, [&](std::size_t p) { // undoes the threads' order
    std::sort(sorted.sides.begin() + sorted.begin[p], sorted.sides.begin() + sorted.begin[p + 1]);
  });
  return sorted;
}

/// For every point the number of edges whose lower point precedes it.
std::vector<std::uint32_t> number_edges(const SortedSides& sorted) {
  std::vector<std::uint32_t> first(sorted.begin.size(), 0);
  parallel_each(first.size() - 1, grain, [&](std::size_t p) {
    for (std::uint32_t i = sorted.begin[p]; i < sorted.begin[p + 1]; ++i)
      first[p + 1] += i == sorted.begin[p] || sorted.sides[i].b != sorted.sides[i - 1].b;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  return first;
}

} // namespace

MeshTopology build_topology(std::uint32_t point_count, std::span<const Triangle> triangles) {
  const SortedSides sorted = sort_sides(point_count, triangles);
  const std::vector<std::uint32_t> first = number_edges(sorted);
  MeshTopology topology;
  topology.edges.resize(first.back());
  topology.edges_of.resize(triangles.size());
  parallel_each(point_count, grain, [&](std::size_t p) {
    std::uint32_t edge = first[p];
    for (std::uint32_t i = sorted.begin[p]; i < sorted.begin[p + 1]; ++i) {
      const Side& side = sorted.sides[i];
      if (i > sorted.begin[p] && side.b != sorted.sides[i - 1].b) ++edge;
      MeshTopology::Edge& record = topology.edges[edge];
      record.a = static_cast<std::uint32_t>(p);
      record.b = side.b;
      ++record.faces;
      topology.edges_of[side.side / 3][side.side % 3] = edge;
    }
  });
  return topology;
}

namespace {

/// A fixed random number per point (splitmix64).
std::uint64_t random_number(std::uint32_t point) {
  std::uint64_t x = (point + 1) * 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Per point, the sum of the random numbers of the higher ends of the sides that it is the lower end of, negative for
/// those passed downwards. Not 0 at the lower end of an open edge, but for one chance in 2^64.
std::vector<std::uint64_t> balance_sides(std::uint32_t point_count, std::size_t count, const std::function<Triangle(std::size_t)>& triangle) {
  std::vector<std::uint64_t> balance(point_count, 0);
  parallel_each(count, grain, [&](std::size_t f) {
    const Triangle t = triangle(f);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = t[k], q = t[(k + 1) % 3];
      const std::uint64_t number = random_number(std::max(p, q));
      std::atomic_ref(balance[std::min(p, q)]).fetch_add(p < q ? number : -number, std::memory_order_relaxed);
    }
  });
  return balance;
}

struct Ends {
  std::uint32_t a = 0, b = 0; ///< a < b
};

/// The sides whose lower ends are out of balance, in the order of the triangles.
std::vector<Ends> unbalanced_sides(std::uint32_t point_count, std::size_t count, const std::function<Triangle(std::size_t)>& triangle) {
  const std::vector<std::uint64_t> balance = balance_sides(point_count, count, triangle);
  std::vector<std::vector<Ends>> blocks((count + grain - 1) / grain);
  parallel_each(blocks.size(), 1, [&](std::size_t block) {
    for (std::size_t f = block * grain; f < std::min(count, (block + 1) * grain); ++f) {
      const Triangle t = triangle(f);
      for (std::size_t k = 0; k < 3; ++k)
        if (const auto [a, b] = ends(t, k); balance[a] != 0) blocks[block].push_back({a, b});
    }
  });
  std::vector<Ends> sides;
  for (const auto& block : blocks) sides.insert(sides.end(), block.begin(), block.end());
  return sides;
}

} // namespace

std::vector<MeshTopology::Edge> find_open_edges(std::uint32_t point_count, std::size_t count, const std::function<Triangle(std::size_t)>& triangle) {
  const std::vector<Ends> sides = unbalanced_sides(point_count, count, triangle);
  std::vector<std::uint32_t> begin(point_count + std::size_t(1), 0);
  for (const Ends& side : sides) ++begin[side.a + std::size_t(1)];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  RawVector<std::uint32_t> higher(sides.size());
  for (const Ends& side : sides) higher[begin[side.a]++] = side.b; // now begin[p] is where p + 1 begins
  std::vector<std::vector<MeshTopology::Edge>> blocks(point_count / grain + 1);
  parallel_each(blocks.size(), 1, [&](std::size_t block) {
    for (std::size_t p = block * grain; p < std::min<std::size_t>(point_count, (block + 1) * grain); ++p) {
      const auto first = higher.begin() + (p == 0 ? 0 : begin[p - 1]), last = higher.begin() + begin[p];
      std::sort(first, last);
      for (auto i = first; i != last; ++i)
        if ((i == first || i[0] != i[-1]) && (i + 1 == last || i[0] != i[1])) blocks[block].push_back({static_cast<std::uint32_t>(p), *i, 1});
    }
  });
  std::vector<MeshTopology::Edge> edges;
  for (const auto& block : blocks) edges.insert(edges.end(), block.begin(), block.end());
  return edges;
}

const MeshTopology::Edge* find_edge(std::span<const MeshTopology::Edge> edges, std::uint32_t p, std::uint32_t q) {
  const auto [a, b] = std::minmax(p, q);
  const auto is_before = [](const MeshTopology::Edge& edge, const std::pair<std::uint32_t, std::uint32_t>& key) { return std::pair(edge.a, edge.b) < key; };
  const auto found = std::lower_bound(edges.begin(), edges.end(), std::pair<std::uint32_t, std::uint32_t>(a, b), is_before);
  return found != edges.end() && found->a == a && found->b == b ? &*found : nullptr;
}

} // namespace domewarp
