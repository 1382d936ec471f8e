// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "domewarp/scene/scene.h"

namespace domewarp::gltf {

/// Fills Scene::materials and Scene::textures from a checked document; out-of-range factors give warnings.
void read_materials(const nlohmann::json& root, Scene& scene);

/// The TEXCOORD sets that the textures of a material object read, in ascending order; at most 31.
std::set<int> texcoord_sets(const std::string& material_json);

} // namespace domewarp::gltf
