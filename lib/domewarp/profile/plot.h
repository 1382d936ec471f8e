// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "domewarp/profile/surface.h"

namespace domewarp {

/// A cross-section of the display for people, as one self-contained svg element (it can stand in an HTML page): the
/// meridian on both sides of the axis with the visible part in red, the tangent extension, the blind cone, sample view
/// rays from the eye with the points where they meet the surface, the image plane, the projector and what it lights;
/// axes in image units, a legend, and the figures that matter. Forward is up.
/// Based on: Figures 9, 13, 14 and 21e-h of the thesis.
std::string plot_svg(const Surface& surface);

} // namespace domewarp
