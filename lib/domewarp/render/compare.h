// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "domewarp/profile/surface.h"
#include "domewarp/render/frame.h"
#include "domewarp/render/image_metrics.h"
#include "domewarp/render/pixel_judge.h"
#include "domewarp/render/screen.h"
#include "domewarp/scene/crossing.h"
#include "domewarp/scene/image.h"
#include "domewarp/scene/raster.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

/// The distance of the grid that rasterisers round corners to, px.
inline constexpr double subpixel_step = 1.0 / 256;

struct CompareOptions {
  double bound_px = 0.5 + subpixel_step; ///< how far from its place anything may be drawn: the file's tolerance and a step
  double depth_bound = 0.004; ///< relative; surfaces nearer to each other than this may be drawn in either order
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

/// |drawn - exact| / exact, where `drawn` is what the depth buffer sorted by and `exact` what the same point of the scene
/// has: its distance times the weight of its direction, or its distance for an orthographic camera. `convert`
/// certifies depth_error_rel along edges; triangles between them may sag by 4/3 of it. How far the point is from its place is the displacement, and not counted here.
struct DepthReport {
  std::size_t measured = 0; ///< pixels; 0 when the warped file carries no source positions, the rest is 0 then
  double max = 0;
  int worst_column = -1, worst_row = -1;
};

struct CompareReport {
  CoverageReport coverage;
  std::size_t pinholes = 0; ///< uncovered in the warped picture, though the scene covers everything within the bound
  std::size_t pinholes_at_seams = 0; ///< those of them where every connected piece of surface ends within the bound: the outlines of two meet
  std::optional<std::size_t> overlaps; ///< pixels covered more often than the scene has triangles there; none without source positions
  std::vector<std::array<int, 2>> flaws; ///< column and row of the first pinholes, mismatches and overlaps, 32 of each kind at most
  std::size_t surface_mismatch = 0; ///< a surface that nothing within the bound lets be seen there
  std::size_t surface_mismatch_at_seams = 0; ///< those of them where every connected piece that hides it ends within the bound
  std::size_t outline = 0;    ///< differ in coverage or surface at an outline, by no more than the bound
  std::size_t depth_ties = 0; ///< show the other of two surfaces that are nearer to each other than the depth bound
  std::size_t arbitrated = 0; ///< pixels that were settled by exact rays
  DisplacementReport displacement_px;
  DepthReport depth_rel;
  std::optional<double> psnr_db; ///< none when the pictures are equal
  std::optional<double> ssim;    ///< none for pictures of less than 11 pixels
  FlipReport flip;
  double colour_difference = 0;  ///< mean |difference| of the colour bytes over pixels covered in both, 0..255

  std::vector<float> displacement; ///< px, by pixel; NaN where not measured
  std::vector<float> depth_off;    ///< by pixel, likewise
  std::vector<Verdict> verdicts;   ///< by pixel
  std::vector<std::uint8_t> covers; ///< by pixel: count_covers() where an overlap was found, else 0
};

/// Judges a rasterised picture of pre-warped geometry by the ray-traced one: what is covered, which surface is seen,
/// and how far from its exact place everything is drawn. Displacement needs no reference: the source position of the
/// warped picture is projected by the branch that owns the pixel's radius (within one pixel of a branch's end by either
/// neighbour, whichever fits better). The objects of the two pictures are matched by what they show, not by their
/// numbers. A pixel is the same without further questions when both show one object in one plane; all others are
/// judged by the rays around them (PixelJudge).
/// @param screen of the scene that the warped frame shows
/// @param crossings all that the reference draws along a ray, nearest first, exactly
/// @throws Error(usage) when the frames and the raster differ in size.
CompareReport compare_frames(const Frame& reference, const Frame& warped, const Screen& screen, const Surface& surface,
                             const ImageMap& map, const Raster& raster, const CrossingsAlong& crossings,
                             const CompareOptions& options = {});

/// The report without its pictures as one JSON object, with the keys that `compare --json` promises.
std::string to_json(const CompareReport& report);

} // namespace domewarp
