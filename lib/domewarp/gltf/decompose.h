// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/core/vectors.h"

namespace domewarp::gltf {

/// An affine matrix as translation * outer rotation * scale * inner rotation. Rotations are unit quaternions x, y, z,
/// w.
struct Decomposition {
  Vec3 translation, scale;
  Vec4 outer, inner;
};

/// True when the columns are at right angles as far as single precision tells: what the matrix of one node can hold.
bool is_decomposable(const Mat4& matrix);

/// True when a node without rotation holds the matrix, to the bit.
bool is_diagonal(const Mat4& matrix);

/// Singular value decomposition, for matrices that shear or flatten: glTF needs two nodes for those. The inner rotation
/// is the identity where one node does.
Decomposition decompose(const Mat4& matrix);

} // namespace domewarp::gltf
