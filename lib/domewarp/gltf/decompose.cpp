// SPDX-License-Identifier: Apache-2.0
// Based on: Hestenes, "Inversion of matrices by biorthogonalization and related results", 1958 (one-sided Jacobi).
#include "domewarp/gltf/decompose.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace domewarp::gltf {

namespace {

/// Turns columns p and q of `a` in their plane until they are orthogonal, and those of `v` alike.
bool orthogonalise(Mat3& a, Mat3& v, int p, int q) {
  const double gamma = glm::dot(a[p], a[q]), alpha = glm::dot(a[p], a[p]), beta = glm::dot(a[q], a[q]);
  if (std::abs(gamma) <= 1e-16 * std::sqrt(alpha * beta)) return false;
  const double zeta = (beta - alpha) / (2 * gamma);
  const double t = (zeta >= 0 ? 1 : -1) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
  const double c = 1 / std::sqrt(1 + t * t), s = c * t;
  for (Mat3* matrix : {&a, &v}) {
    const Vec3 column = (*matrix)[p];
    (*matrix)[p] = c * column - s * (*matrix)[q];
    (*matrix)[q] = s * column + c * (*matrix)[q];
  }
  return true;
}

/// Fills in directions for the columns whose length is 0.
void complete(Mat3& u, const Vec3& lengths) {
  const double least = 1e-300;
  for (int i = 0; i < 3; ++i) {
    if (lengths[i] > least) continue;
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const bool has_j = lengths[j] > least || j<i, has_k = lengths[k]> least || k < i;
    const Vec3 other = has_j ? u[j] : has_k ? u[k] : Vec3(0, 0, 1);
    const Vec3 across = std::abs(other.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    u[i] = has_j && has_k ? glm::cross(u[j], u[k]) : glm::normalize(glm::cross(other, across));
  }
}

/// Shepperd's method: the largest component first.
Vec4 quaternion(const Mat3& m) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  int largest = 3;
  for (int i = 0; i < 3; ++i)
    if (m[i][i] > (largest == 3 ? trace : m[largest][largest])) largest = i;
  Vec4 q;
  if (largest == 3) {
    q = {m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0], 1 + trace};
  } else {
    const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
    q[i] = 1 + m[i][i] - m[j][j] - m[k][k];
    q[j] = m[i][j] + m[j][i];
    q[k] = m[i][k] + m[k][i];
    q[3] = m[j][k] - m[k][j];
  }
  return glm::normalize(q);
}

} // namespace

namespace {

bool has_right_angles(const Mat4& matrix, double tolerance) {
  const Vec3 x(matrix[0]), y(matrix[1]), z(matrix[2]);
  const double lx = glm::length(x), ly = glm::length(y), lz = glm::length(z);
  const auto is_right = [&](const Vec3& a, const Vec3& b, double product) {
    return std::abs(glm::dot(a, b)) <= tolerance * product;
  };
  return lx * ly * lz > 0 && is_right(x, y, lx * ly) && is_right(y, z, ly * lz) && is_right(z, x, lz * lx);
}

} // namespace

bool is_decomposable(const Mat4& matrix) {
  return has_right_angles(matrix, 1e-6);
}

bool is_diagonal(const Mat4& matrix) {
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (r != c && matrix[c][r] != 0) return false;
  return true;
}

Decomposition decompose(const Mat4& matrix) {
  Mat3 u(matrix), v(1);
  // Columns of equal length are turned by 45 degrees for an angle that is off by one rounding.
  const int sweeps = has_right_angles(matrix, 1e-14) ? 0 : 30;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const bool first = orthogonalise(u, v, 0, 1), second = orthogonalise(u, v, 0, 2), third = orthogonalise(u, v, 1, 2);
    if (!first && !second && !third) break;
  }
  Decomposition result;
  result.translation = Vec3(matrix[3]);
  for (int i = 0; i < 3; ++i) {
    result.scale[i] = glm::length(u[i]);
    if (result.scale[i] > 1e-300) u[i] /= result.scale[i];
  }
  complete(u, result.scale);
  if (glm::determinant(u) < 0) {
    u[0] = -u[0];
    result.scale[0] = -result.scale[0];
  }
  result.outer = quaternion(u);
  result.inner = quaternion(glm::transpose(v));
  return result;
}

} // namespace domewarp::gltf
