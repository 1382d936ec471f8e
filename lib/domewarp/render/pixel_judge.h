// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "domewarp/profile/surface.h"
#include "domewarp/scene/crossing.h"
#include "domewarp/scene/raster.h"

namespace domewarp {

/// What became of one pixel.
enum class Verdict : std::uint8_t {
  background,    ///< nothing in either picture
  same,          ///< the surface that is seen there
  depth_tie,     ///< another one, but the two are nearer to each other than drawn depths are exact
  outline,       ///< another one or none, next to an outline or the picture's rim, which may be displaced by that much
  pinhole,       ///< nothing is drawn, though the scene covers everything within the bound
  seam_pinhole,  ///< the same, where every piece of connected surface in the pixel ends within the bound: the outlines of two meet there
  mismatch,      ///< a surface that is hidden there, or none of the scene
  seam_mismatch, ///< a hidden surface shows, where every piece of connected surface that hides it ends within the bound
};

/// How many rays a pixel is judged by: a few, or 2048 more, evenly over the disc of the bound, that find slivers and the
/// holes of masked textures.
enum class Search : bool { quick, close };

/// Judges pixels by what the scene has along the rays around them. A quick search may find a flaw where there is none.
class PixelJudge {
 public:
  /// @param crossings all that is drawn of the scene along a ray, nearest first
  /// @param bound_px how far from its place anything may be drawn
  /// @param depth_bound surfaces nearer to each other than this (relative) may be drawn in either order
  PixelJudge(const Surface& surface, const Raster& raster, CrossingsAlong crossings, double bound_px,
             double depth_bound);

  /// A pixel where the warped picture shows the source position p (eye space) of an object of the scene, which lies
  /// `displacement_px` from its place. @param object 0 when it is unknown
  Verdict judge_drawn(int column, int row, const Vec3& p, std::uint32_t object, double displacement_px,
                      Search search = Search::quick) const;

  /// The same for a picture that knows the object only.
  Verdict judge_object(int column, int row, std::uint32_t object, Search search = Search::quick) const;

  /// A pixel where the warped picture shows nothing.
  Verdict judge_bare(int column, int row, Search search = Search::quick) const;

  /// Whether at least so many triangles of one object lie within the bound at about this distance: each of them may
  /// cover the pixel once.
  bool has_triangles(int column, int row, std::uint32_t object, double distance, std::size_t count,
                     Search search = Search::quick) const;

 private:
  struct Probe;
  class Probes;

  const Surface& surface_;
  Raster raster_;
  CrossingsAlong crossings_;
  double bound_px_, depth_bound_;
};

} // namespace domewarp
