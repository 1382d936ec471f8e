// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/profile/surface.h"

namespace domewarp {

/// One line for titles: the curve, lens or file, and the projector.
std::string name_of(const Surface& surface);

/// Smallest and largest theta that some branch shows, radians.
Vec2 visible_range(const Surface& surface);

/// Full field of view, radians: twice the visible angle from the axis it lies around (backward when f(0) < 0).
double field_of_view(const Surface& surface);

/// Where the profile curve is defined and continuous: on [0, end], searched up to `searched_to` along the curve; equal
/// when no end was found, or the surface is a lens.
struct Domain {
  double end = 0, searched_to = 0;
};
Domain find_domain(const Surface& surface);

/// One clause that says why r_max is what it is.
std::string explain_r_max(const Surface& surface);

/// One clause that says what of the surface the projector cannot light; empty without a projector.
std::string explain_projector(const Surface& surface);

/// What there is to say about a surface, for people, one fact a line.
std::vector<std::string> summarise(const Surface& surface);

} // namespace domewarp
