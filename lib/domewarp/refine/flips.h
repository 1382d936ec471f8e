// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "domewarp/refine/refined_mesh.h"

namespace domewarp {

/// Whether a visible face appears turned over.
bool is_flipped(const std::array<const MappedPoint*, 3>& corner, int orientation, double thickness);

/// The longest sides (in the image) of final faces that appear turned over: thin faces seen nearly edge-on, whose side
/// bends farther than they are thick. They are within the tolerance, but a viewer that culls back faces drops them.
/// Splitting a side takes three quarters of its bend away.
/// @param orientation of the branch
/// @param thickness image units: thinner faces may appear turned over (OracleOptions::turned_thickness)
/// @param first of the final faces to look at
/// @return edges of mesh.edges, ascending, each once; a function of positions alone, whatever the order of faces
std::vector<std::uint32_t> sides_of_flipped_faces(const RefinedMesh& mesh, std::size_t first, int orientation, double thickness);

} // namespace domewarp
