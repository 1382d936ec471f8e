// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "domewarp/render/parts.h"
#include "domewarp/scene/crossing.h"

namespace domewarp {

/// Keeps the crossings that both renderers draw: no culled back faces, no masked or invisible fragments, nothing nearer
/// than `near`.
/// @param parts of the scene that was crossed
std::vector<Crossing> keep_drawn(const Parts& parts, std::vector<Crossing> crossings, double near);

} // namespace domewarp
