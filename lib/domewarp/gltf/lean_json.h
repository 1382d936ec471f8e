// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace domewarp::gltf {

/// The part of a checked document that is parsed into structs: known properties only, whole numbers as integers,
/// buffers and images under the names "buffer/N" and "image/N", images that lie in views left without bytes.
/// @param buffer_sizes what each buffer really holds; 0 becomes a placeholder of one byte.
nlohmann::json lean_json(const nlohmann::json& root, const std::vector<std::size_t>& buffer_sizes);

} // namespace domewarp::gltf
