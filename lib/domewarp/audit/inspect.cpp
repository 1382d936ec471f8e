// SPDX-License-Identifier: GPL-3.0-or-later
#include "domewarp/audit/inspect.h"

#include <algorithm>
#include <array>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "domewarp/audit/hanging.h"
#include "domewarp/mesh/half_edges.h"

namespace domewarp {

namespace {

double diagonal(const std::vector<Vec3>& positions) {
  if (positions.empty()) return 0;
  Vec3 low = positions[0], high = low;
  for (const Vec3& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return glm::length(high - low);
}

std::size_t count_duplicates(std::vector<Corners> triangles) {
  for (Corners& t : triangles) std::sort(t.begin(), t.end());
  std::sort(triangles.begin(), triangles.end());
  const auto unique_end = std::unique(triangles.begin(), triangles.end());
  return static_cast<std::size_t>(triangles.end() - unique_end);
}

/// Triangles that cover nothing; those exactly on a line still fill their neighbours' edges and stay in `welded`.
std::size_t count_degenerate(const Drawn& drawn, const std::vector<Corners>& welded) {
  const auto on_line = std::count_if(welded.begin(), welded.end(), [&](const Corners& t) {
    return are_collinear(drawn.position[t[0]], drawn.position[t[1]], drawn.position[t[2]]);
  });
  return drawn.triangles.size() - welded.size() + static_cast<std::size_t>(on_line);
}

void find_t_junctions(const Drawn& drawn, const std::vector<Ends>& open, InspectReport& report) {
  const double tolerance = 1e-5 * diagonal(drawn.position);
  const std::vector<std::uint32_t> vertices = ends_of(open);
  for (const HangingVertex& hanging : find_hanging_vertices(drawn.position, open, vertices, [&](const Vec3&, const Vec3&) { return tolerance; })) {
    ++report.t_junctions;
    const Vec3 a = drawn.position[open[hanging.edge][0]], b = drawn.position[open[hanging.edge][1]];
    report.max_gap = std::max(report.max_gap, glm::length(drawn.position[vertices[hanging.vertex]] - (a + hanging.t * (b - a))));
  }
}

} // namespace

InspectReport inspect(const Scene& scene, const InspectOptions& options) {
  InspectReport report;
  report.meshes = scene.meshes.size();
  report.instances = scene.instances.size();
  for (const Mesh& mesh : scene.meshes) report.primitives += mesh.primitives.size();
  report.materials = scene.materials.size();
  const Drawn drawn = collect_drawn(scene);
  report.triangles = drawn.triangles.size();
  report.vertices = drawn.position.size();
  const std::vector<Corners> triangles = weld_triangles(drawn.triangles, first_equal(drawn.position, {}, report.unique_positions));
  report.degenerate = count_degenerate(drawn, triangles);
  report.duplicate = count_duplicates(triangles);
  const EdgeUse use = use_edges(triangles);
  report.open_edges = use.open.size();
  report.non_manifold_edges = use.non_manifold;
  const MeshShape shape = walk_half_edges(static_cast<std::uint32_t>(drawn.position.size()), triangles);
  report.boundary_loops = shape.boundary_loops;
  report.euler_characteristic = shape.euler_characteristic();
  find_t_junctions(drawn, use.open, report);

  const Provenance provenance = find_provenance(scene, drawn, options.picture);
  if (provenance.source.empty() && options.picture == nullptr) return report;
  std::optional<SourceMesh> source;
  if (options.source != nullptr && options.picture != nullptr) source = make_source_mesh(*options.source, options.picture->view);
  const bool perspective = options.picture != nullptr ? options.picture->perspective : scene.cameras.empty() || scene.cameras.front().perspective;
  const Raster raster = options.picture != nullptr ? options.picture->raster : Raster{};
  report.cracks = find_cracks(drawn, provenance, perspective, raster.height, options.picture, source ? &*source : nullptr);
  if (source) report.coverage = measure_coverage(drawn, provenance, *options.picture, *source, options.samples);
  if (source && options.hausdorff_px) report.hausdorff = measure_hausdorff(drawn, *options.picture, *source, *options.hausdorff_px);
  return report;
}

bool is_sound(const InspectReport& report) {
  if (report.cracks) {
    const CrackReport& cracks = *report.cracks;
    if (cracks.torn_positions + cracks.t_junctions + cracks.flips > 0) return false;
    if (cracks.source_known && cracks.open_edges > 0) return false;
  }
  return !report.coverage || report.coverage->lost + report.coverage->overlapping == 0;
}

} // namespace domewarp
