// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// Warns of animations that could not be played: channels with the same target, weights without morph targets,
/// rotations that are not unit, data of the wrong shape. The scene is read at rest.
void check_animations(const Document& document, Budget& budget, std::vector<std::string>& warnings);

} // namespace domewarp::gltf
