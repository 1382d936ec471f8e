// SPDX-License-Identifier: Apache-2.0
#include "domewarp/mesh/point_tree.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

constexpr std::uint32_t leaf_size = 8;

/// Whether the segment from a, along d, passes the box (slab test; a box of a single point counts with its faces).
bool passes(const Vec3& a, const Vec3& d, const Vec3& low, const Vec3& high) {
  double enter = 0, leave = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0) {
      if (a[axis] < low[axis] || a[axis] > high[axis]) return false;
      continue;
    }
    const auto [near, far] = std::minmax({(low[axis] - a[axis]) / d[axis], (high[axis] - a[axis]) / d[axis]});
    enter = std::max(enter, near);
    leave = std::min(leave, far);
  }
  return enter <= leave * (1 + 1e-12) + 1e-12;
}

} // namespace

PointTree::PointTree(std::span<const Vec3> points, std::vector<std::uint32_t> ids) : points_(points), ids_(std::move(ids)) {
  if (!ids_.empty()) build(0, static_cast<std::uint32_t>(ids_.size()));
}

void PointTree::build(std::uint32_t begin, std::uint32_t end) {
  Node node{points_[ids_[begin]], points_[ids_[begin]], begin, end, 0};
  for (std::uint32_t i = begin; i < end; ++i) {
    node.low = glm::min(node.low, points_[ids_[i]]);
    node.high = glm::max(node.high, points_[ids_[i]]);
  }
  const std::size_t own = nodes_.size();
  nodes_.push_back(node);
  if (end - begin <= leaf_size) return;
  const Vec3 extent = node.high - node.low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(ids_.begin() + begin, ids_.begin() + middle, ids_.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(points_[a][axis], a) < std::pair(points_[b][axis], b);
  });
  build(begin, middle);
  nodes_[own].right = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

void PointTree::visit_near_segment(const Vec3& a, const Vec3& b, double reach, const std::function<bool(std::uint32_t)>& visit) const {
  std::array<std::uint32_t, 64> open; // halving 2^32 points never goes deeper
  std::size_t count = 0;
  if (!nodes_.empty()) open[count++] = 0;
  while (count > 0) {
    const std::uint32_t index = open[--count];
    const Node& node = nodes_[index];
    if (!passes(a, b - a, node.low - Vec3(reach), node.high + Vec3(reach))) continue;
    if (node.right == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        if (!visit(ids_[i])) return;
      continue;
    }
    open[count++] = node.right;
    open[count++] = index + 1;
  }
}

// The lower id counts a pair, and the higher one where it alone reaches the other.
std::size_t count_near_pairs(const PointTree& tree, const std::function<double(const Vec3&)>& reach) {
  constexpr std::size_t most = 64; // of one point
  std::atomic<std::size_t> pairs = 0;
  parallel_ranges(tree.ids().size(), 128, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t own = tree.ids()[i];
      const Vec3 p = tree.points()[own];
      const double far = reach(p);
      std::size_t own_pairs = 0, near = 0; // near: those counted by the other point, too
      tree.visit_near_segment(p, p, far, [&](std::uint32_t other) {
        const double distance = glm::length(tree.points()[other] - p);
        if (other == own || distance > far) return true;
        own_pairs += own < other || distance > reach(tree.points()[other]);
        return ++near < most;
      });
      here += own_pairs;
    }
    pairs += here;
  });
  return pairs;
}

} // namespace domewarp
