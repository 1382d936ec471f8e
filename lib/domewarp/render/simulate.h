// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "domewarp/core/vectors.h"
#include "domewarp/profile/surface.h"
#include "domewarp/scene/image.h"
#include "domewarp/scene/raster.h"
#include "domewarp/scene/view.h"

namespace domewarp {

/// A perspective camera at the viewer's eye.
struct EyeCamera {
  Vec3 look = Vec3(0, 0, -1); ///< eye space (x right, y up, the display's axis along -z), not zero
  double fov_deg = 60;        ///< vertical, between 0 and 180
  Raster raster{1024, 768};
};

enum class PictureFilter {
  linear, ///< between the picture's pixels, as a slightly defocused projector
  nearest ///< the pixels themselves, as squares
};

struct SimulateOptions {
  PictureFilter filter = PictureFilter::linear;
  int samples = 16; ///< per pixel of the view, 1 to 4096
};

/// Where a picture's pixel lies that is seen in some direction.
class DisplayedPicture {
 public:
  /// @param raster of the picture; @param surface must outlive the object
  DisplayedPicture(const Surface& surface, const Raster& raster);
  ~DisplayedPicture();
  DisplayedPicture(const DisplayedPicture&) = delete;
  DisplayedPicture& operator=(const DisplayedPicture&) = delete;

  /// @param direction eye space, finite and not zero
  /// @return column and row of the picture (centres at half-integers, from its top left corner), inside it or not;
  ///         nothing where the display has no point or the projector cannot light it
  std::optional<Vec2> pixel(const Vec3& direction) const;

  /// The same, and nothing outside the picture either.
  std::optional<Vec2> pixel_inside(const Vec3& direction) const;

  /// The point of the display that is seen; image units, eye space. Likewise.
  std::optional<Vec3> point(const Vec3& direction) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// Eye-space direction, not unit, through a point of the camera's picture. @param column, row 0 at the top left corner
Vec3 direction_through(const EyeCamera& camera, double column, double row);

/// The display seen from the eye: the picture is thrown by the surface's projector (orthographically without one) onto
/// the surface, of which the eye sees the nearest point in every direction. Transparent where nothing is shown. Linear
/// light, the same for any number of threads.
/// Based on: Figures 22 and 28 of the thesis.
/// @param picture for this surface, of any size; its shape is that of the projector's picture
/// @throws Error(usage) for a camera or a number of samples out of range
Pixels simulate(const Pixels& picture, const Surface& surface, const EyeCamera& camera, const SimulateOptions& options);

/// What a camera at the eye sees without any display: the view to trace and the flat surface to trace it on, with the
/// camera's raster. @throws Error(usage)
View turn_view(const View& view, const EyeCamera& camera);
Surface flat_surface(const EyeCamera& camera);

/// The display with the picture on it from outside, behind the viewer and to one side: the picture on the side that the
/// eye sees, a grey shell, the eye's camera with the part that it sees in red, rays of the projector in yellow.
/// @param raster of the view
Pixels outside_view(const Pixels& picture, const Surface& surface, const EyeCamera& camera, const Raster& raster);

} // namespace domewarp
