// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/convert.h"

#include <chrono>

#include <sys/resource.h>

#include "domewarp/convert/record.h"
#include "domewarp/core/errors.h"

namespace domewarp {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void warn_of_undrawn_primitives(const Scene& scene, std::vector<std::string>& warnings) {
  std::size_t lines = 0, points = 0;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives) {
      lines += primitive.topology == Topology::lines;
      points += primitive.topology == Topology::points;
    }
  if (lines + points > 0)
    warnings.push_back("left out " + std::to_string(lines) + " primitive(s) of lines and " + std::to_string(points) + " of points");
}

} // namespace

Scene convert(const Scene& scene, const ConvertOptions& options, ConvertReport& report) {
  const Clock::time_point start = Clock::now();
  if (options.raster.width <= 0 || options.raster.height <= 0)
    throw Error(ErrorCode::usage, "--size: must be at least 1x1");
  report.warnings = scene.warnings;
  report.dropped_extensions = scene.dropped_extensions;
  warn_of_undrawn_primitives(scene, report.warnings);
  report.view = resolve_view(scene, options.view);

  const Surface surface(options.surface, screen_radius(options.raster));
  const ImageMap map = make_image_map(surface, options.method);
  report.r_max = surface.r_max();
  report.r_max_limit = surface.r_max_limit();
  report.branches = surface.branches();
  for (const BranchMap& branch : map.branches) report.tables.push_back(branch.table());
  report.map_ms = ms_since(start);

  Scene warped = refine(scene, report.view, surface, map, options.raster, options.refine, report.refine);
  if (options.unlit)
    for (Material& material : warped.materials) material.unlit = true;
  report.total_ms = ms_since(start);
  report.peak_memory_mb = peak_memory_mb();
  warped.extras = to_json(make_record(options, report));
  return warped;
}

bool is_kept(const ConvertReport& report, const ConvertOptions& options) {
  return report.refine.limits_hit.empty() && report.refine.open_edges == 0 &&
         (options.refine.subdivision != Subdivision::adaptive || report.refine.error_px_max <= options.refine.tolerance_px * (1 + 1e-6));
}

} // namespace domewarp
