// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/scene/scene.h"

namespace domewarp {

/// Removes the material extensions that speak of lengths inside the mesh, which are wrong once it is warped.
/// @return their names, each once
std::vector<std::string> drop_geometric_extensions(Scene& scene);

} // namespace domewarp
