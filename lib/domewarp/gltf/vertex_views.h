// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// Warns of views that several vertex accessors share without the byteStride that glTF asks for there.
void check_vertex_views(const Document& document, std::vector<std::string>& warnings);

} // namespace domewarp::gltf
