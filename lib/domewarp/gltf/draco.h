// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

struct DracoAttribute {
  std::string name;
  int components = 0;
  std::vector<double> values; ///< n x components, as stored: not normalised
};

struct DracoMesh {
  std::size_t vertices = 0;
  std::vector<DracoAttribute> attributes;
  std::vector<std::uint32_t> indices; ///< three per triangle, every one < vertices
};

/// Decodes a KHR_draco_mesh_compression stream.
/// @param ids   names and the unique ids that Draco knows them by.
/// @throws Error(input) when the stream is invalid, claims more than its bytes can hold, or lacks an id.
DracoMesh decode_draco(std::span<const std::uint8_t> stream, const AttributeMap& ids, const std::string& place,
                       Budget& budget);

} // namespace domewarp::gltf
