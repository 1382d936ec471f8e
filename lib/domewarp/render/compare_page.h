// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "domewarp/profile/surface.h"
#include "domewarp/render/compare.h"
#include "domewarp/scene/image.h"

namespace domewarp {

/// What a page about a comparison shows.
struct ComparePage {
  std::string scene, warped, renderer; ///< file names and the rasteriser, as they are called
  double tolerance_px = 0.5;
  double bound_px = 0.5 + subpixel_step; ///< how far from its place anything may be drawn
  Pixels reference, rasterised, difference, displacement, cracks, wireframe;
};

/// One HTML page that needs nothing else: no file, no network. The figures, the display's cross-section, both pictures
/// under a slider, the displacement with its scale, the difference, the crack map and the wireframe, each at most
/// `widest` pixels wide (smaller by averaging).
std::string compare_page(const ComparePage& page, const CompareReport& report, const Surface& surface, int widest = 1400);

} // namespace domewarp
