// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// Bytes of one component: 1, 2 or 4. @throws Error(input) for an unknown type.
std::size_t component_size(int component_type, const std::string& place);

/// All values, n x components (matrices column by column), normalised integers as -1..1 or 0..1, sparse values put in.
/// @throws Error(input) when the accessor reaches beyond its view.
std::vector<float> read_floats(const Document& document, int accessor, Budget& budget);

/// The same for accessors that hold indices or joints: unsigned integers that are not normalised.
std::vector<std::uint32_t> read_naturals(const Document& document, int accessor, Budget& budget);

/// The value of an integer component as glTF's accessor tells to read it.
double dequantised(double value, const Accessor& accessor);

/// Looks at every accessor, used or not, and warns of wrong bounds, alignment, ranges and counts.
void check_accessors(const Document& document, Budget& budget, std::vector<std::string>& warnings);

} // namespace domewarp::gltf
