// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "domewarp/refine/levels.h"

namespace domewarp {

enum class FaceFate : std::uint8_t {
  refine, ///< its edges decide
  whole,  ///< drawn as it is
  drop,   ///< nothing of it can be seen
};

/// The faces of a soup, by what becomes of them.
struct SiftedFaces {
  RawVector<FaceFate> fate;            ///< per face
  std::vector<std::uint32_t> refine;     ///< in the order of the soup
  std::vector<WholeFace> whole;          ///< in the order of the soup
  float depth_error = 0;                 ///< of the whole ones, relative
  std::size_t clipped = 0, off_picture = 0;
};

/// Tells from the three corners of each face alone what needs no edge to be decided: that it lies well outside what the
/// branch shows, or well inside and is so small that one bound proves all of it good. That bound never says so of a face
/// one of whose edges EdgeOracle::decide would split, so no neighbour ever has a vertex on a whole face's side.
/// @param points of the soup, located
SiftedFaces sift_faces(const Soup& soup, std::span<const MappedPoint> points, const EdgeOracle& oracle, const LevelOptions& options);

} // namespace domewarp
