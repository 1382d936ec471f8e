// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "domewarp/core/progress.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/test_scenes.h"
#include "figure_drawings.h"

namespace domewarp {

/// The multi-valued curve of Figure 21b.
inline constexpr const char* folded_curve = "-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1";

/// What the figures are made of.
struct Studio {
  std::vector<TestScene> scenes; ///< the bundled five
  Raster raster{800, 600};       ///< of every picture
  int samples = 32;              ///< in pixels that need them

  const Scene& scene(const std::string& name) const;
};

/// Figures 9, 10, 11, 12, 20, 21, 22 and 23: surfaces and traced rays.
std::vector<Figure> ray_figures(const Studio& studio, const Progress& progress);

/// Figures 19, 21b, 24, 27 and 28: warped points, where there are two renderers both.
std::vector<Figure> point_figures(const Studio& studio, const Progress& progress);

/// A traced panorama. @param samples 1 for none of the antialiasing
Pixels panorama(const Studio& studio, const Scene& scene, const SurfaceOptions& surface, int samples);

/// The same from warped points.
Pixels warped_panorama(const Studio& studio, const Scene& scene, const SurfaceOptions& surface, bool isotropic = false, bool wireframe = false);

/// A curve with or without a projector.
SurfaceOptions curve(const std::string& f, std::optional<double> projector = std::nullopt, std::optional<double> rmax = std::nullopt);

/// Outside view, view from the eye, and an enlarged part of that.
std::vector<Figure> simulated(const Studio& studio, const std::string& number, const Pixels& picture, const SurfaceOptions& surface);

} // namespace domewarp
