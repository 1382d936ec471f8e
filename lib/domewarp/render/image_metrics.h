// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "domewarp/scene/image.h"

namespace domewarp {

// How much two pictures of one size differ. Colours are laid over black where they are transparent. The same numbers
// for any number of threads.

/// Peak signal-to-noise ratio of the red, green and blue bytes in dB; none when they are equal.
std::optional<double> psnr_db(const Pixels& a, const Pixels& b);

/// Mean structural similarity of the luma (Rec. 709 weights on sRGB bytes), 1 when equal: Gaussian window of 11 x 11
/// with sigma 1.5, K1 = 0.01, K2 = 0.03, over the windows that lie inside the picture; none for pictures smaller
/// than the window.
std::optional<double> structural_similarity(const Pixels& a, const Pixels& b);

struct FlipReport {
  double mean = 0, max = 0; ///< 0 none .. 1 largest difference that is seen
};

/// The difference a viewer sees who flips between the pictures.
/// @param pixels_per_degree of the viewing angle; 67 is a 0.7 m wide 4K monitor at 0.7 m
FlipReport flip(const Pixels& reference, const Pixels& test, double pixels_per_degree = 67);

} // namespace domewarp
