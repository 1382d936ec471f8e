// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "domewarp/refine/levels.h"

namespace domewarp {

struct IsotropicOptions {
  double threshold = 0.1;        ///< longest edge of a drawn triangle, image units, > 0
  int max_lod = 9;               ///< how often a triangle may be divided, 0 to 12
};

struct IsotropicReport {
  std::size_t divisions = 0;
  std::size_t points = 0;        ///< as the thesis' Table 3 counts: 3 per triangle and 12 per division (erratum 13)
  std::size_t points_computed = 0; ///< what its pseudo code transforms: 3 per triangle and 3 per division
  std::size_t invisible = 0;     ///< triangles dropped because all three corners are beyond r_max (erratum 9)
  bool stopped = false;          ///< by the limit on triangles
};

/// The subdivision of the thesis, cracks included: every triangle on its own is cut into four at the middles of its
/// edges while its longest edge in the image exceeds the threshold. Corners beyond r_max lie on the tangent extension,
/// blind ones at an extreme radius. The baseline of the benchmarks and the negative control of the crack audit.
/// @param soup from make_loose_soup: no corner is shared
/// @param map of the same surface; each point appears on the first branch that shows it
/// @return no edge records; the same for any number of threads
RefinedMesh subdivide_isotropic(const Soup& soup, const Surface& surface, const ImageMap& map, Projection projection,
                                const IsotropicOptions& options, std::size_t max_triangles, IsotropicReport& report);

} // namespace domewarp
