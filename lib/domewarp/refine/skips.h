// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace domewarp {

/// Work that a picture does not need. Each can be done all the same, to measure what leaving it out saves.
struct SkipOptions {
  bool outside_view = true;      ///< primitives whose bounding cone misses everything the picture shows
  bool back_faces = true;        ///< faces of single-sided materials that the eye sees from behind
  bool off_picture = true;       ///< pieces outside the image rectangle, as soon as that is certain
  bool small_faces = true;       ///< the decisions about edges of faces that one bound proves good as they are
  bool zero_area = true;         ///< triangles whose written corners coincide
  bool unused_attributes = true; ///< attributes that no material reads
};

/// What `--no-skip` calls them.
struct SkipName {
  const char* name;
  bool SkipOptions::*member;
};
inline constexpr SkipName skip_names[] = {{"outside-view", &SkipOptions::outside_view},
                                          {"back-faces", &SkipOptions::back_faces},
                                          {"off-picture", &SkipOptions::off_picture},
                                          {"small-faces", &SkipOptions::small_faces},
                                          {"zero-area", &SkipOptions::zero_area},
                                          {"unused-attributes", &SkipOptions::unused_attributes}};

/// Triangles (of the source, unless it says refined) that each kind of skipping left out.
struct SkipReport {
  std::size_t outside_view = 0;
  std::size_t back_faces = 0;
  std::size_t degenerate = 0;    ///< two corners at one position: they cover nothing
  std::size_t off_picture = 0;   ///< refined triangles outside the image rectangle, and pieces that were not refined for it
  std::size_t small_faces = 0;   ///< faces of the source that one bound proved good, whose edges were not looked at
  std::size_t zero_area = 0;     ///< refined triangles two of whose written corners coincide
  std::size_t hidden = 0;        ///< refined triangles that RefineOptions::is_hidden named
  std::size_t attributes = 0, unused_attributes = 0; ///< of the primitives written, _SOURCE_POSITION apart; and those left out
};

} // namespace domewarp
