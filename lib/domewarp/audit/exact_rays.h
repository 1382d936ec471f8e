// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "domewarp/scene/crossing.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"

namespace domewarp {

/// The arbiter for rays that rounding cannot settle: whether a ray from the eye meets a triangle, and which of two it
/// meets first, is decided exactly for the double-precision corners in eye space. A ray through an edge or a corner
/// meets every triangle there; one that lies in a triangle's plane does not meet it. Shares no code with the ray
/// tracer. Materials play no part: back faces and transparent texels are met too. Safe to share between threads.
class ExactRays {
public:
  ExactRays(const Scene& scene, const View& view);
  ~ExactRays();
  ExactRays(ExactRays&&) noexcept;
  ExactRays& operator=(ExactRays&&) noexcept;

  /// Ordered by exact distance, then by object and triangle.
  std::vector<Crossing> crossings(const Vec3& direction) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace domewarp
