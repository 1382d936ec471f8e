// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this folder.

#include <nlohmann/json_fwd.hpp>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// Takes over the extras of everything that a warped file still has, but for the names of morph targets, which are posed,
/// and lists what else has some. Materials and textures keep theirs in their own texts.
void read_extras(const nlohmann::json& root, Document& document);

} // namespace domewarp::gltf
