// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "domewarp/scene/scene.h"

namespace domewarp::gltf {

/// Indices of lists from those of glTF's modes 0 to 6 (points, lines, loop, line strip, triangles, strip, fan), in
/// the order and winding of the specification. Indices left over are dropped with a warning.
/// @throws Error(input) for another mode.
std::vector<std::uint32_t> list_indices(int mode, std::vector<std::uint32_t> indices, const std::string& place,
                                        std::vector<std::string>& warnings);

Topology topology_of(int mode);

/// Swaps the winding of every triangle. Points and lines stay.
void reverse_triangles(std::vector<std::uint32_t>& indices, Topology topology);

} // namespace domewarp::gltf
