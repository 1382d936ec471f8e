// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

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

/// A ray in eye space.
struct Ray {
  Vec3 direction = Vec3(0); ///< unit
  double near = 0;          ///< hits nearer to the eye do not count
  const RayHit* previous = nullptr; ///< the hit looked for comes after this one, in the order (nearness, object, triangle)
};

/// The triangles of a scene seen from the eye, ready for rays. The answers are those of a double-precision test that
/// is watertight along shared edges, with ties settled by (object, triangle); Embree only proposes candidates.
/// So they do not depend on its instruction set. Safe to share between threads.
class RayGeometry {
 public:
  static constexpr std::size_t packet_size = 16;

  /// @param parts must outlive the object
  /// @param embree device configuration, empty for Embree's own choice
  /// @throws Error(output) when Embree refuses, for instance for lack of memory
  RayGeometry(const Parts& parts, const View& view, const std::string& embree);
  ~RayGeometry();
  RayGeometry(const RayGeometry&) = delete;
  RayGeometry& operator=(const RayGeometry&) = delete;

  /// The first hit of every ray from the eye. Culled back faces, masked and invisible fragments do not count.
  /// @param rays at most packet_size; quickest where they go the same way
  /// @param hits one per ray, `part` null where nothing is there
  void first_hits(std::span<const Ray> rays, RayHit* hits) const;

  /// Whether something stands between `near` and `far` along a unit direction from any point of eye space. Both sides
  /// of every triangle do, and so do masked texels that are there; blended surfaces do not.
  bool is_blocked(const Vec3& origin, const Vec3& direction, double near, double far) const;

  /// The triangles that a point of eye space lies on, to `tolerance`, in no particular order; without culled back faces.
  /// `weights` are those of the point's projection onto the triangle's plane; `distance` and `order` are not set.
  void triangles_at(const Vec3& point, double tolerance, std::vector<RayHit>& hits) const;

  /// The point's barycentric weights in the triangle of a hit, as `triangles_at` gives them; nothing when it is farther
  /// from the triangle than the tolerance.
  std::optional<std::array<double, 3>> weights_at(const RayHit& hit, const Vec3& point, double tolerance) const;

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
