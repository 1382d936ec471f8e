// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "domewarp/core/vectors.h"
#include "domewarp/render/parts.h"
#include "domewarp/scene/view.h"

namespace domewarp {

/// Where a ray from the eye meets a triangle, in double precision.
struct RayHit {
  double distance = 0; ///< along the unit direction
  double order = 0;    ///< distance rounded to 2^-44 of itself: what counts as equally near
  const Part* part = nullptr;
  std::uint32_t triangle = 0; ///< index in the primitive
  double weights[3] = {};     ///< barycentric, sum 1
};

/// The triangles of a scene seen from the eye, ready for rays. The answers are those of a double-precision test that
/// is watertight along shared edges, with ties settled by (object, triangle); Embree only proposes candidates.
/// So they do not depend on its instruction set. Safe to share between threads.
class RayGeometry {
 public:
  /// @param parts must outlive the object
  /// @param embree device configuration, empty for Embree's own choice
  /// @throws Error(output) when Embree refuses, for instance for lack of memory
  RayGeometry(const Parts& parts, const View& view, const std::string& embree);
  ~RayGeometry();
  RayGeometry(const RayGeometry&) = delete;
  RayGeometry& operator=(const RayGeometry&) = delete;

  /// The first hit along a unit eye-space direction at `near` or beyond, or the first one after `previous` in the order
  /// (nearness, object, triangle). Culled back faces, masked and invisible fragments do not count.
  /// @return false when nothing is there
  bool first_hit(const Vec3& direction, double near, const RayHit* previous, RayHit& hit) const;

  /// Eye-space corner (0, 1, 2) of the triangle that was hit.
  const Vec3& corner(const RayHit& hit, int i) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Texture coordinates, colours and other attributes at a hit; `fallback` when there is no attribute. Missing fourth
/// components are 1.
Vec4 interpolate(const Attribute* attribute, const RayHit& hit, const Vec4& fallback);

} // namespace domewarp
