// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "domewarp/scene/scene.h"

namespace domewarp {

/// Tells which attributes a viewer reads: texture coordinates up to the last set that a texture of the material names,
/// COLOR_0, normals of lit materials, tangents where a normal map or anisotropy needs them, and what applications define
/// (names that begin with an underscore).
/// @param unlit all materials count as unlit
std::function<bool(int material, const std::string& attribute)> attribute_reader(const Scene& scene, bool unlit);

} // namespace domewarp
