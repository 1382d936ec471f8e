// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// Moves nodes and morph weights of the document to where an animation has them at `time`. Before its first key and
/// after its last one a channel holds its value. Channels that cannot be followed are named in `warnings` and left out.
/// @param animation name or index
/// @throws Error(usage) when the file has no such animation; Error(input) when keys and values disagree
void apply_animation(const std::string& animation, double time, Document& document, Budget& budget,
                     std::vector<std::string>& warnings);

} // namespace domewarp::gltf
