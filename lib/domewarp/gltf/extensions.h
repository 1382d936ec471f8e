// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// @throws Error(input) naming a required extension that is neither understood nor harmless to ignore.
/// Fills Scene::dropped_extensions and warns of undeclared and misplaced extensions.
void check_extensions(const nlohmann::json& root, Scene& scene);

bool is_required(const nlohmann::json& root, const std::string& extension);

/// Reads the extension objects of views, primitives and nodes into a document that the rest of `root` has filled.
void read_extensions(const nlohmann::json& root, Document& document);

/// KHR_lights_punctual, in the file's order.
std::vector<Light> read_lights(const nlohmann::json& root, std::vector<std::string>& warnings);

/// Names and channels of the animations.
void read_animations(const nlohmann::json& root, Document& document);

} // namespace domewarp::gltf
