// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace domewarp {

/// Work that a picture does not need. Each can be done all the same, to measure what leaving it out saves.
struct SkipOptions {
  bool outside_view = true;      ///< primitives whose bounding cone misses everything the picture shows
  bool back_faces = true;        ///< faces of single-sided materials that the eye sees from behind
  bool zero_area = true;         ///< triangles whose written corners coincide
};

/// Triangles (of the source, unless it says refined) that each kind of skipping left out.
struct SkipReport {
  std::size_t outside_view = 0;
  std::size_t back_faces = 0;
  std::size_t degenerate = 0;    ///< two corners at one position: they cover nothing
  std::size_t off_picture = 0;   ///< refined triangles outside the image rectangle
  std::size_t zero_area = 0;     ///< refined triangles two of whose written corners coincide
};

} // namespace domewarp
