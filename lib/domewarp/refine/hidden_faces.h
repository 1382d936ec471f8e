// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "domewarp/refine/refine.h"

namespace domewarp {

/// Distance from the origin to the nearest point of a triangle.
double nearest_distance(const Vec3& a, const Vec3& b, const Vec3& c);

/// What RefineOptions::is_hidden, which must be given, says of a finished face.
bool is_hidden(const std::array<const MappedPoint*, 3>& corner, const RefineOptions& options);

} // namespace domewarp
