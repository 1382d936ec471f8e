// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "domewarp/core/vectors.h"

namespace domewarp {

/// A set of points, halved again and again along the longest axis of its box, for questions of nearness.
class PointTree {
public:
  /// @param points must outlive the tree
  /// @param ids which of them, finite ones only
  PointTree(std::span<const Vec3> points, std::vector<std::uint32_t> ids);

  /// Calls visit(id) for every point within `reach` of the segment from a to b, and some farther ones, until it answers
  /// false. The order is a function of the tree alone.
  void visit_near_segment(const Vec3& a, const Vec3& b, double reach, const std::function<bool(std::uint32_t)>& visit) const;

  std::span<const Vec3> points() const { return points_; }
  std::span<const std::uint32_t> ids() const { return ids_; }

private:
  struct Node {
    Vec3 low, high;
    std::uint32_t begin = 0, end = 0; ///< into ids_
    std::uint32_t right = 0;          ///< 0 for a leaf; the left child follows its parent
  };

  void build(std::uint32_t begin, std::uint32_t end);

  std::span<const Vec3> points_;
  std::vector<std::uint32_t> ids_;
  std::vector<Node> nodes_;
};

/// How many pairs of the tree's points are at most reach(point) of either apart, 64 of each point at most: a million points
/// in one place must not take a million times a million steps.
/// @param reach >= 0, of a point
std::size_t count_near_pairs(const PointTree& tree, const std::function<double(const Vec3&)>& reach);

} // namespace domewarp
