// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "domewarp/refine/refine.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"

namespace domewarp {

/// How light becomes vertex colours.
struct BakeOptions {
  bool shadows = false;  ///< opaque and masked surfaces keep the scene's lights away
  double tolerance = 4;  ///< what a white surface may be off along an edge longer than RefineOptions::criterion_px, steps of 1/255 of sRGB
  double exposure = 0;   ///< of the scene's lights, stops
};

struct BakeReport {
  std::size_t lights = 0;            ///< of the scene; without any, one at the eye
  std::size_t vertices = 0;
  std::size_t clipped_vertices = 0;  ///< brighter than a colour can be
  double brightest = 0;              ///< linear, 1 is white
  std::size_t glowing_materials = 0; ///< whose light depends on a texture, so that COLOR_0 cannot hold it: left out
};

/// The light that falls on a scene seen from one place: what the ray tracer (shading.h) multiplies a surface's colour
/// with, from the scene's punctual lights, or from one at the eye when it has none. Direct light only.
class LightBaker {
public:
  /// @param scene must outlive the object
  /// @throws Error(input) when the scene is inconsistent, Error(output) when Embree fails
  LightBaker(const Scene& scene, const View& view, const BakeOptions& options);
  ~LightBaker();
  LightBaker(const LightBaker&) = delete;
  LightBaker& operator=(const LightBaker&) = delete;

  /// Sets what asks for vertices where light changes fast, and what colours them. The object must outlive their use.
  void attach(RefineOptions& options);

  /// Marks the materials KHR_materials_unlit, their glow folded into the colours where that can be, drops normals and
  /// tangents, which nothing reads any more, and tells what was done.
  BakeReport finish(Scene& warped) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One sentence each about light that a file of colours could not hold.
std::vector<std::string> bake_warnings(const BakeReport& report);

} // namespace domewarp
