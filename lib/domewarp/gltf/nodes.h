// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// Column-major 4 x 4.
Mat4 matrix_of(const std::vector<double>& values);

/// T * R * S; each may be empty. The rotation (x, y, z, w) is normalised, zero counts as none.
Mat4 matrix_of(const std::vector<double>& translation, const std::vector<double>& rotation,
               const std::vector<double>& scale);

/// The parent of every node, -1 for roots.
/// @throws Error(input) when a node has two parents or is its own ancestor.
std::vector<int> find_parents(const std::vector<NodeSource>& nodes);

/// World matrices of all nodes, as products in double precision from the root down.
/// @throws Error(input) when one is not finite or not affine.
std::vector<Mat4> world_matrices(const std::vector<NodeSource>& nodes, const std::vector<int>& parents);

/// Whether the numbers of a world matrix stay within single precision; NaN does not.
bool fits_single_precision(const Mat4& world);

} // namespace domewarp::gltf
