// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "domewarp/transform/image_map.h"
#include "reference_curves.h"

namespace domewarp {

/// What is right about a display, in sixty digits from its formula. From the surface under test it takes only where
/// about to look for the ends of branches; what it finds there shares no code with it.
class Oracle {
public:
  virtual ~Oracle() = default;

  struct Answer {
    PointState state = PointState::blind;
    std::size_t branch = 0; ///< nearest of those that show a visible point
    /// The direction is within 1e-30 of an edge that is itself a rounded number: `other`, what lies across it, is as right.
    bool is_close = false;
    PointState other = PointState::blind;
  };
  /// @param p finite, not zero
  virtual Answer answer(const Vec3& p) const = 0;

  /// Whether the image radius of p on the branch lies within radius (1 -+ relative) -+ absolute.
  virtual bool confirms(std::size_t branch, const Vec3& p, double radius, double relative, double absolute) const = 0;
};

/// A surface under test with its oracle.
struct Case {
  std::string name;
  Surface surface;
  std::unique_ptr<const Oracle> oracle;
};

Case curve_case(const ReferenceCurve& curve, double screen, double projector);
Case lens_case(Lens lens, double fov_deg, double screen);

/// Every thesis curve at two screens with and without a projector, every lens.
std::vector<Case> all_cases();

/// Angles at which something changes: branch ends and the edges of the blind cone, radians.
std::vector<double> critical_angles(const Surface& surface);

} // namespace domewarp
