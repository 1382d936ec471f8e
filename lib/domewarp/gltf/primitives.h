// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "domewarp/gltf/document.h"
#include "domewarp/scene/scene.h"

namespace domewarp::gltf {

/// What skinning needs of one set JOINTS_n, WEIGHTS_n: four of each per vertex.
struct Influences {
  std::vector<std::uint32_t> joints;
  std::vector<float> weights;
};

/// A decoded primitive, before morph targets and skins have moved it.
struct PrimitiveParts {
  Primitive primitive;
  std::vector<Influences> influences;
};

/// Decodes vertices and indices. A primitive without positions comes back empty.
/// @throws Error(input) when counts or indices disagree, a position is not finite, or a stream is invalid.
PrimitiveParts read_primitive(const Document& document, const PrimitiveSource& source, const std::string& place,
                              Budget& budget, std::vector<std::string>& warnings);

/// Makes normals unit; replaces those that have no direction by the mean of their triangles'. Tangents likewise
/// become unit, and values of other attributes that are not finite become 0.
void repair_attributes(Primitive& primitive, const std::string& place, std::vector<std::string>& warnings);

} // namespace domewarp::gltf
