// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/scene.h"
#include "domewarp/transform/image_map.h"

namespace domewarp::bench {

/// Second derivatives of a planar vector map along two orthogonal unit directions of a plane: uu, uv, vv.
using Hessian = std::array<Vec2, 3>;

/// E_1: the least, over the shapes of triangles of unit area, of the largest error of linear interpolation of a map with
/// this (constant) second derivative: triangles of area A in that place are off by at least E_1 A. A local minimum over
/// 27 stretches, 24 directions of stretch and 8 turns, errors taken at seven points.
double least_error(const Hessian& hessian);

/// N*: how many triangles orthographic output of these triangles (eye space, as drawn through `map`) needs at least for
/// this tolerance (image units), as it becomes small: the integral of E_1 / tolerance over what the branch shows.
/// @param parts into which each side of a source triangle is cut for the sum
double least_triangles(const Scene& scene, const BranchMap& map, double tolerance, int parts);

} // namespace domewarp::bench
