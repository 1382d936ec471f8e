// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/render/compare.h"
#include "domewarp/render/frame.h"
#include "domewarp/render/screen.h"
#include "domewarp/scene/image.h"

namespace domewarp {

/// The displacement of every pixel in false colours, dark blue none, red `full_scale_px` and more; magenta pinholes,
/// white mismatches, greys where nothing was measured; below it the scale in pixels.
Pixels displacement_picture(const CompareReport& report, int width, int height, double full_scale_px);

/// |reference - warped| of every channel, four times enlarged; magenta where only one picture is covered.
Pixels difference_picture(const Frame& reference, const Frame& warped);

/// The warped picture, dimmed, with what is wrong in it: pinholes magenta, overlaps yellow, mismatches white, depth ties
/// blue, each but the last with a ring around it.
Pixels crack_picture(const CompareReport& report, const Frame& warped);

/// The warped picture with the visible edges of its triangles.
/// @param screen of the scene that the frame shows
Pixels wireframe_picture(const Frame& warped, const Screen& screen);

} // namespace domewarp
