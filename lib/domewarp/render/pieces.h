// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "domewarp/render/parts.h"

namespace domewarp {

/// The connected pieces of a scene's surface: triangles that share a vertex, by the bits of its world position, are one
/// piece, across primitives and objects. Pieces that share no vertex touch at most by chance, and nothing keeps what is
/// drawn of them together.
class Pieces {
 public:
  explicit Pieces(const Parts& parts);

  /// @param part index in Parts::parts @param triangle in its primitive
  std::uint32_t of(std::size_t part, std::size_t triangle) const { return piece_of_[first_of_[part] + triangle]; }

 private:
  std::vector<std::size_t> first_of_;     ///< by part
  std::vector<std::uint32_t> piece_of_;   ///< by triangle, all parts counted
};

} // namespace domewarp
