// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "domewarp/audit/coverage.h"
#include "domewarp/audit/cracks.h"
#include "domewarp/audit/hausdorff.h"

namespace domewarp {

/// Mesh statistics of all drawn triangles of a scene together, welded by exact world position.
struct InspectReport {
  std::size_t meshes = 0, instances = 0, primitives = 0, materials = 0;
  std::size_t triangles = 0;        ///< drawn
  std::size_t vertices = 0;         ///< drawn, as stored: seams count twice
  std::size_t unique_positions = 0;
  std::size_t open_edges = 0;       ///< of one triangle
  std::size_t non_manifold_edges = 0; ///< of three or more
  std::size_t boundary_loops = 0;   ///< of the half-edge structure (mesh/half_edges.h)
  long long euler_characteristic = 0; ///< of the same
  std::size_t degenerate = 0;       ///< triangles with two equal corners or exactly on one line
  std::size_t duplicate = 0;        ///< triangles with the three corners of an earlier one
  std::size_t t_junctions = 0;      ///< vertices of open edges inside another open edge, within 1e-5 of the diagonal
  double max_gap = 0;               ///< largest distance of such a vertex from its edge, scene units
  std::optional<CrackReport> cracks; ///< only for warped files: those with a picture or _SOURCE_POSITION
  std::optional<CoverageReport> coverage; ///< only where picture and source are known
  std::optional<HausdorffReport> hausdorff; ///< only where it was asked for
};

struct InspectOptions {
  const Picture* picture = nullptr; ///< what the file says about the picture it draws
  const Scene* source = nullptr;    ///< the scene it was made from
  std::size_t samples = 50'000;     ///< of the source's triangles
  std::optional<double> hausdorff_px = std::nullopt; ///< measure the Hausdorff distance to this error (hausdorff.h); needs picture and source
};

/// Shares no code with refinement: edges by sorting, T-junctions by CGAL. Degenerate triangles have no edges here.
InspectReport inspect(const Scene& scene, const InspectOptions& options = {});

/// Whether a warped file has no torn position, T-junction, flip, lost or overlapping sample, and, where the source is
/// known, no open edge that it lacks.
bool is_sound(const InspectReport& report);

std::string to_json(const InspectReport& report);
std::string to_text(const InspectReport& report);

} // namespace domewarp
