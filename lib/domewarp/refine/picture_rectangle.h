// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "domewarp/refine/refine.h"

namespace domewarp {

/// Half the width and height (image units) of the rectangle about the image's centre that faces must meet to be kept: the
/// picture, and room for the tolerance and the rasteriser's own rounding.
Vec2 kept_half_extent(const RefineOptions& options, const Raster& raster);

/// Whether all the image points lie beyond one side of the rectangle, and so all between them.
bool is_beyond(std::span<const Vec2> points, const Vec2& half_extent);

} // namespace domewarp
