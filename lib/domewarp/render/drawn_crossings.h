// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/scene/crossing.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

/// Of the crossings with a scene, those that both renderers draw: no culled back faces, no masked or invisible
/// fragments, nothing nearer than `near`. Each is told its piece of connected surface. The scene must outlive the result.
CrossingsAlong keep_drawn(const Scene& scene, CrossingsAlong crossings, double near);

} // namespace domewarp
