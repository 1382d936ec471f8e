// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace domewarp {

/// How a triangle is divided when some of its edges are split. Local vertices: 0, 1, 2 the corners, 3, 4, 5 the split
/// points of edges 0-1, 1-2, 2-0. All faces counter-clockwise.
struct SplitPattern {
  int faces = 0;
  std::array<std::array<std::uint8_t, 3>, 4> face{};
  int edges = 0;                                      ///< new edges inside the triangle
  std::array<std::array<std::uint8_t, 2>, 3> edge{};
};

/// The patterns that fit the marks (bit k: edge k is split); 1 for one mark, 2 for two, 4 for three.
struct PatternChoice {
  int count = 0;
  std::array<SplitPattern, 4> pattern{};
};
const PatternChoice& patterns_for(unsigned marks);

} // namespace domewarp
