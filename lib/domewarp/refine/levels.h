// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "domewarp/refine/picture_cull.h"
#include "domewarp/refine/refined_mesh.h"

namespace domewarp {

struct LevelOptions {
  std::size_t max_triangles = 0;
  const PictureCull* cull = nullptr; ///< drops what the picture does not show, before it is refined; null: nothing is dropped
  bool small_faces = true;           ///< faces that one bound proves good become RefinedMesh::whole
  std::span<const std::uint8_t> plain_faces = {}; ///< per face of the soup (plain_faces.h); empty: none is
};

/// Refines level by level until no edge asks for a split. Deterministic for any number of threads.
RefinedMesh refine_levels(const Soup& soup, const EdgeOracle& oracle, const LevelOptions& options);

} // namespace domewarp
