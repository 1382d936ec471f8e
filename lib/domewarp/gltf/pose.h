// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/gltf/document.h"
#include "domewarp/gltf/primitives.h"

namespace domewarp::gltf {

/// Adds the weighted displacements of the morph targets to positions and attributes.
/// @throws Error(input) when a target has another number of vertices.
void apply_morph_targets(const Document& document, const PrimitiveSource& source, const std::vector<double>& weights,
                         const std::string& place, Budget& budget, std::vector<std::string>& warnings,
                         Primitive& primitive);

/// World matrix times inverse bind matrix of every joint.
/// @throws Error(input) when there are fewer inverse bind matrices than joints or one is not finite.
std::vector<Mat4> joint_matrices(const Document& document, int skin, const std::vector<Mat4>& world, Budget& budget,
                                 std::vector<std::string>& warnings);

/// Moves positions, normals and tangents to world space by linear blend skinning. Weights that do not add up to 1
/// are scaled with a warning; a vertex without any weight follows its first joint.
/// @throws Error(input) when a joint does not exist or a result is not finite.
void apply_skin(const std::vector<Influences>& influences, const std::vector<Mat4>& joints, const std::string& place,
                std::vector<std::string>& warnings, Primitive& primitive);

} // namespace domewarp::gltf
