// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/scene/scene.h"

namespace domewarp {

/// Orders triangles for the vertex cache and vertices for fetching, without changing the picture: blended primitives
/// and those that hold one triangle twice, where the order decides what is seen, keep the order of their triangles.
void optimize_vertex_order(Scene& scene);

} // namespace domewarp
