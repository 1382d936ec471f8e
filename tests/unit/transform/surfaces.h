// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "domewarp/transform/image_map.h"
#include "reference_curves.h"

namespace domewarp {

inline constexpr double corner_radius = 5.0 / 3; // of a 4:3 picture

inline Surface curve_surface(const std::string& text, std::optional<double> projector = std::nullopt,
                             double screen = corner_radius) {
  SurfaceOptions options;
  options.curve = text;
  options.projector = projector;
  return {options, screen};
}

inline Surface lens_surface(Lens lens, double fov_deg, std::optional<double> projector = std::nullopt) {
  SurfaceOptions options;
  options.lens = lens;
  options.fov_deg = fov_deg;
  options.projector = projector;
  return {options, corner_radius};
}

/// Every thesis curve at the corners of two pictures, with and without a projector, and every lens.
inline std::vector<Surface> many_surfaces() {
  std::vector<Surface> surfaces;
  std::vector<ReferenceCurve> curves = reference_curves();
  curves.push_back(fisheye_curve());
  for (const ReferenceCurve& curve : curves)
    for (const double screen : {1.0, corner_radius}) {
      surfaces.push_back(curve_surface(curve.text, std::nullopt, screen));
      surfaces.push_back(curve_surface(curve.text, 1.5, screen));
    }
  for (const char* text : {"1", "-1+r^2", "sqrt(abs(1-r^2))"}) surfaces.push_back(curve_surface(text));
  surfaces.push_back(curve_surface("-tanh(r-1)", std::nullopt, 3));
  for (const double fov : {60.0, 180.0, 300.0}) {
    surfaces.push_back(lens_surface(Lens::equidistant, fov));
    surfaces.push_back(lens_surface(Lens::equisolid, fov, 2.0));
    surfaces.push_back(lens_surface(Lens::stereographic, fov));
  }
  surfaces.push_back(lens_surface(Lens::equidistant, 360));
  surfaces.push_back(lens_surface(Lens::equisolid, 360));
  surfaces.push_back(lens_surface(Lens::orthographic, 180));
  return surfaces;
}

inline std::string describe(const Surface& surface) {
  const SurfaceOptions& options = surface.options();
  std::string text =
      options.lens ? "lens " + std::to_string(static_cast<int>(*options.lens)) + " " + std::to_string(options.fov_deg)
                   : options.curve;
  if (options.projector) text += " projector " + std::to_string(*options.projector);
  return text + " r_max " + std::to_string(surface.r_max());
}

/// Eye-space direction.
inline Vec3 towards(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta)};
}

/// Directions within the branch: even, and close to either end in steps of powers of ten.
inline std::vector<double> branch_angles(const Branch& branch, std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> angles{branch.theta_low, branch.theta_high};
  const double width = branch.theta_high - branch.theta_low;
  for (int i = 0; i < count; ++i) angles.push_back(branch.theta_low + width * uniform(random));
  for (double part = 0.1; part > 1e-17; part *= 0.1) {
    angles.push_back(branch.theta_low + width * part);
    angles.push_back(branch.theta_high - width * part);
  }
  return angles;
}

} // namespace domewarp
