// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace domewarp::gltf {

/// Index of the first entry of this name, or of the entry with this index.
/// @throws Error(usage) naming `option` when there is neither; `what` is what the entries are
std::size_t find_by_name(const std::string& name_or_index, const std::vector<std::string>& names, const char* option,
                         const char* what);

} // namespace domewarp::gltf
