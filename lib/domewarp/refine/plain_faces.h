// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "domewarp/refine/refine.h"
#include "domewarp/refine/soup.h"

namespace domewarp {

/// Per face of the soup 1 when it is plain: whatever is read of its attributes (texture coordinates, colours, normals) has
/// the same values at its three corners, so it looks the same wherever its points slide to along its plane. With
/// RefineOptions::vertex_colour none is.
std::vector<std::uint8_t> find_plain_faces(const Scene& scene, const Soup& soup, const RefineOptions& options);

} // namespace domewarp
