// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "domewarp/scene/scene.h"

namespace domewarp::checks {

using Triangle = std::array<Vec3, 3>;

/// All primitives of a mesh, in the mesh's own space.
std::vector<Triangle> triangles_of(const Mesh& mesh);
/// Everything that is drawn, in world space.
std::vector<Triangle> triangles_of(const Scene& scene);

struct EdgeUse {
  int open = 0;    ///< sides of triangles that no other triangle runs along the other way
  int crowded = 0; ///< directions of edges that more than one triangle runs along
};
/// Corners are the same where they are equal to the bit.
EdgeUse count_edge_uses(const std::vector<Triangle>& triangles);

/// Corners of triangles that lie within `tolerance` of the inner part of another triangle's side.
int count_t_junctions(const std::vector<Triangle>& triangles, double tolerance);

/// Pairs of triangles in one plane (within `tolerance`) that share more than an outline.
int count_overlaps(const std::vector<Triangle>& triangles, double tolerance);

/// The smallest height of the triangle, 0 when its corners lie on a line.
double smallest_height(const Triangle& triangle);

/// Six times the volume that the triangles enclose; negative when they face inwards.
double signed_volume(const std::vector<Triangle>& triangles);

/// Distance along the ray to the nearest triangle that faces it, or infinity.
double cast(const std::vector<Triangle>& triangles, const Vec3& origin, const Vec3& direction);

} // namespace domewarp::checks
