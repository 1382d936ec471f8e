// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/nodes.h"

#include <algorithm>
#include <cmath>

namespace domewarp::gltf {

Mat4 matrix_of(const std::vector<double>& values) {
  Mat4 matrix;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) matrix[column][row] = values[4 * static_cast<std::size_t>(column) + static_cast<std::size_t>(row)];
  // Products of float32 matrices leave rounding in the last row, which is (0, 0, 0, 1) by definition.
  for (int column = 0; column < 4; ++column) {
    const double exact = column == 3 ? 1 : 0;
    if (std::abs(matrix[column][3] - exact) < 1e-6) matrix[column][3] = exact;
  }
  return matrix;
}

namespace {

Mat3 rotation_matrix(double x, double y, double z, double w) {
  return Mat3(Vec3(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)),
              Vec3(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)),
              Vec3(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)));
}

bool is_affine(const Mat4& matrix) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(matrix[column][row])) return false;
  return matrix[0][3] == 0 && matrix[1][3] == 0 && matrix[2][3] == 0 && matrix[3][3] == 1;
}

} // namespace

// The area of a triangle squared, of coordinates of single precision, stays far below what double precision holds.
bool fits_single_precision(const Mat4& world) {
  constexpr double largest = 3e38;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!(std::abs(world[c][r]) <= largest)) return false;
  return true;
}

Mat4 matrix_of(const std::vector<double>& translation, const std::vector<double>& rotation,
               const std::vector<double>& scale) {
  Mat4 matrix(1);
  if (rotation.size() == 4) {
    const double length = std::hypot(std::hypot(rotation[0], rotation[1]), std::hypot(rotation[2], rotation[3]));
    // float32 unit quaternions are off by 1e-7; dividing them would move every exported node in its last bits.
    const double divisor = std::abs(length - 1) < 1e-6 ? 1 : length;
    if (length > 0)
      matrix = Mat4(
          rotation_matrix(rotation[0] / divisor, rotation[1] / divisor, rotation[2] / divisor, rotation[3] / divisor));
  }
  if (scale.size() == 3)
    for (int i = 0; i < 3; ++i) matrix[i] *= scale[static_cast<std::size_t>(i)];
  if (translation.size() == 3) matrix[3] = Vec4(translation[0], translation[1], translation[2], 1);
  return matrix;
}

std::vector<int> find_parents(const std::vector<NodeSource>& nodes) {
  std::vector<int> parents(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (const int child : nodes[i].children) {
      int& parent = parents[static_cast<std::size_t>(child)];
      if (parent >= 0)
        refuse(at("nodes", static_cast<std::size_t>(child)),
               "has two parents, nodes " + std::to_string(parent) + " and " + std::to_string(i));
      parent = static_cast<int>(i);
    }
  return parents;
}

std::vector<Mat4> world_matrices(const std::vector<NodeSource>& nodes, const std::vector<int>& parents) {
  std::vector<Mat4> world(nodes.size());
  std::vector<int> order;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (parents[i] < 0) order.push_back(static_cast<int>(i));
  for (std::size_t done = 0; done < order.size(); ++done) {
    const auto node = static_cast<std::size_t>(order[done]);
    const Mat4& local = nodes[node].local;
    if (!is_affine(local)) refuse(at("nodes", node), "has a matrix that is not finite and affine");
    world[node] = parents[node] < 0 ? local : world[static_cast<std::size_t>(parents[node])] * local;
    if (!is_affine(world[node])) refuse(at("nodes", node), "has a world matrix that overflows");
    if (!fits_single_precision(world[node])) refuse(at("nodes", node), "has a world matrix beyond what single precision holds");
    order.insert(order.end(), nodes[node].children.begin(), nodes[node].children.end());
  }
  // Every node has at most one parent, so what no root reaches hangs on a loop.
  if (order.size() < nodes.size()) {
    std::vector<bool> reached(nodes.size());
    for (const int node : order) reached[static_cast<std::size_t>(node)] = true;
    const auto lost = std::find(reached.begin(), reached.end(), false) - reached.begin();
    refuse(at("nodes", static_cast<std::size_t>(lost)), "belongs to a loop of nodes");
  }
  return world;
}

} // namespace domewarp::gltf
