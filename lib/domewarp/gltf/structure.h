// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace domewarp::gltf {

/// Checks everything that is read later: required properties are there, have their type, and every index refers to
/// something that exists.
/// @throws Error(input) with the place and the defect. Harmless oddities (empty lists) become warnings.
void check_structure(const nlohmann::json& root, std::vector<std::string>& warnings);

} // namespace domewarp::gltf
