// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "domewarp/profile/surface.h"
#include "domewarp/render/frame.h"
#include "domewarp/scene/image.h"
#include "domewarp/scene/raster.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

struct CompareOptions {
  double depth_tolerance = 0.01; ///< relative; depths farther apart than this belong to different surfaces
};

/// What became of one pixel.
enum class Verdict : std::uint8_t {
  background,     ///< nothing in either picture
  same,           ///< the same surface in both, or one next to it
  reference_only, ///< covered in the reference only, at an outline
  warped_only,    ///< covered in the warped picture only
  pinhole,        ///< a hole inside a surface, see CompareReport::pinholes
  mismatch,       ///< another surface, see CompareReport::surface_mismatch
};

/// Pixels that are covered.
struct CoverageReport {
  std::size_t reference = 0, warped = 0, both = 0;
};

/// From the pixel centre to the exact image of what the pixel shows, in px.
struct DisplacementReport {
  std::size_t measured = 0; ///< pixels; 0 when the warped file carries no source positions, the rest is 0 then
  double max = 0, p999 = 0, rms = 0;
  int worst_column = -1, worst_row = -1;
};

/// |warped - reference| / reference inside surfaces: where both pictures show one object and the reference's depth is
/// smooth over 3 x 3 pixels. On a slanted surface the displacement shows here too.
struct DepthReport {
  std::size_t measured = 0; ///< pixels
  double max = 0;
};

struct CompareReport {
  CoverageReport coverage;
  /// Pixels uncovered in the warped picture, although the reference covers them and their 8 neighbours.
  std::size_t pinholes = 0;
  /// Pixels covered in both, where the reference shows this object at this depth nowhere within one pixel.
  std::size_t surface_mismatch = 0;
  DisplacementReport displacement_px;
  DepthReport depth_rel;
  std::optional<double> psnr_db; ///< of the red, green and blue bytes of all pixels; none when they are equal
  double colour_difference = 0;  ///< mean |difference| of those bytes over pixels covered in both, 0..255

  std::vector<float> displacement; ///< px, by pixel; NaN where not measured
  std::vector<Verdict> verdicts;   ///< by pixel
};

/// Judges a rasterised picture of pre-warped geometry by the ray-traced one: what is covered, which surface is seen,
/// and how far from its exact place everything is drawn. Displacement needs no reference: the source position of the
/// warped picture is projected by the branch that owns the pixel's radius (within one pixel of a branch's end by either
/// neighbour, whichever fits better). The objects of the two pictures are matched by what they show, not by their
/// numbers.
/// @throws Error(usage) when the frames and the raster differ in size.
CompareReport compare_frames(const Frame& reference, const Frame& warped, const Surface& surface, const ImageMap& map,
                             const Raster& raster, const CompareOptions& options = {});

/// The report without its pictures as one JSON object, with the keys that `compare --json` promises.
std::string to_json(const CompareReport& report);

/// The displacement of every pixel in false colours: blue none, red `full_scale_px` and more; magenta pinholes, white
/// mismatches, greys where only one picture is covered; below it a strip with the scale.
Pixels displacement_picture(const CompareReport& report, const Raster& raster, double full_scale_px);

/// |reference - warped| of every channel, four times enlarged; magenta where only one picture is covered.
Pixels difference_picture(const Frame& reference, const Frame& warped);

} // namespace domewarp
