// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/convert.h"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <optional>
#include <sstream>

#include "domewarp/convert/hidden.h"
#include "domewarp/convert/read_attributes.h"
#include "domewarp/convert/record.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/memory.h"

namespace domewarp {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

void check_raster(const Raster& raster) {
  if (raster.width <= 0 || raster.height <= 0) throw Error(ErrorCode::usage, "--size: must be at least 1x1");
}

void note_display(const Display& display, ConvertReport& report) {
  report.r_max = display.surface.r_max();
  report.r_max_limit = display.surface.r_max_limit();
  report.branches = display.surface.branches();
  for (const BranchMap& branch : display.map.branches) report.tables.push_back(branch.table());
}

/// The lights that stay right when everything else is warped: normals are in eye space, and so are the directions of these.
/// Point and spot lights have a place, and no place in the warped space shines on all surfaces as theirs did.
std::vector<Light> lights_in_eye_space(const Scene& scene, const View& view, std::vector<std::string>& warnings) {
  std::vector<Light> lights;
  for (const Light& light : scene.lights) {
    if (light.kind != LightKind::directional) continue;
    lights.push_back(light);
    lights.back().world = world_to_eye(view) * light.world;
    lights.back().world[3] = Vec4(0, 0, 0, 1);
  }
  if (lights.size() < scene.lights.size())
    warnings.push_back("left out " + std::to_string(scene.lights.size() - lights.size()) + " point or spot light(s), which would shine wrongly on warped surfaces: --shading bake puts their light into the colours, --shading unlit does without");
  return lights;
}

void check_shading(const ConvertOptions& options) {
  if (!(options.bake.tolerance > 0))
    throw Error(ErrorCode::usage, "--light-tolerance: must be greater than 0, got " + std::to_string(options.bake.tolerance));
  if (options.shading == Shading::bake && !(options.refine.criterion_px > 0))
    throw Error(ErrorCode::usage, "convert: criterion_px must be greater than 0 to bake light, got " + std::to_string(options.refine.criterion_px));
  if (options.bake.shadows && options.shading != Shading::bake) throw Error(ErrorCode::usage, "--shadows: needs --shading bake");
}

Scene refine_and_bake(const Scene& scene, const ConvertOptions& options, const Display& display, RefineOptions refine_options, ConvertReport& report) {
  LightBaker baker(scene, report.view, options.bake);
  baker.attach(refine_options);
  Scene warped = refine(scene, report.view, display.surface, display.map, options.raster, refine_options, report.refine);
  report.baked = baker.finish(warped);
  for (const std::string& warning : bake_warnings(report.baked)) report.warnings.push_back(warning);
  return warped;
}

/// The thesis' recursion knows triangles only.
void warn_of_lines(const RefineOptions& options, ConvertReport& report) {
  if (options.subdivision != Subdivision::isotropic || report.refine.lines_in + report.refine.points_in == 0) return;
  report.warnings.push_back("left out " + std::to_string(report.refine.lines_in) + " line(s) and " + std::to_string(report.refine.points_in) +
                            " point(s): --subdivide isotropic divides triangles only");
}

void note_extension(const ConvertOptions& options, const Display& display, ConvertReport& report) {
  const double asked = options.surface.extension_deg;
  if (asked == 0) return;
  if (options.cull_hidden) throw Error(ErrorCode::usage, "--cull-hidden: cannot be used with --boundary tangent, since no ray sees what lies beyond r_max");
  const Branch &clipped = display.surface.branches().back(), &drawn = display.map.branches.back().branch();
  report.extension_deg = (drawn.theta_high - drawn.theta_low - clipped.theta_high + clipped.theta_low) * 180 / std::numbers::pi;
  if (report.extension_deg < asked * (1 - 1e-9))
    report.warnings.push_back("--boundary tangent goes on for " + std::to_string(report.extension_deg) + " of " + std::to_string(asked) +
                              " degrees: " + (report.extension_deg == 0 ? "at r_max the surface folds back or its tangent is vertical" : "blind directions are near"));
}

} // namespace

std::size_t expected_points(const Scene& scene, const ConvertOptions& options) {
  constexpr std::size_t per_vertex = 10;
  if (options.refine.subdivision == Subdivision::none) return count_vertices(scene);
  const std::size_t refined = per_vertex * count_vertices(scene);
  if (options.refine.subdivision == Subdivision::isotropic || count_triangles(scene) == 0 || !(options.refine.tolerance_px > 0)) return refined;
  // However few its vertices: the error of an edge grows with its length squared, so covering the view takes about as
  // many pieces as there are tolerances in the picture's height.
  return std::max(refined, static_cast<std::size_t>(std::min(options.raster.height / options.refine.tolerance_px, 1e6)));
}

Scene convert(const Scene& scene, const ConvertOptions& options, ConvertReport& report, const Progress& progress) {
  check_raster(options.raster);
  const Clock::time_point start = Clock::now();
  const Display display = make_display(options.surface, options.raster, options.method, expected_points(scene, options));
  const double map_ms = ms_since(start);
  Scene warped = convert(scene, options, display, report, progress);
  report.map_ms = map_ms;
  report.total_ms += map_ms;
  return warped;
}

namespace {

/// @param owned the scene itself, where its geometry may be freed once it is no longer needed; else null
Scene convert_scene(const Scene& scene, Scene* owned, const ConvertOptions& options, const Display& display, ConvertReport& report,
                    const Progress& progress) {
  check_raster(options.raster);
  check_shading(options);
  const Clock::time_point start = Clock::now();
  report.warnings = scene.warnings;
  report.dropped_extensions = scene.dropped_extensions;
  report.dropped_extras = scene.dropped_extras;
  report.view = resolve_view(scene, options.view);
  note_display(display, report);
  note_extension(options, display, report);
  report.expected_points = expected_points(scene, options);

  tell(progress, "refine");
  RefineOptions refine_options = options.refine;
  if (!refine_options.reads) refine_options.reads = attribute_reader(scene, options.shading == Shading::unlit);
  std::optional<SeenDepths> seen;
  if (options.cull_hidden) {
    tell(progress, "hidden");
    const Clock::time_point rays = Clock::now();
    seen.emplace(scene, report.view, display.surface, options.raster);
    report.hidden_ms = ms_since(rays);
    const double margin = (1 + options.refine.tolerance_px) * pixel_size(options.raster);
    refine_options.is_hidden = [&seen, margin](const Vec2& low, const Vec2& high, double nearest) { return seen->is_hidden(low, high, margin, nearest); };
    tell(progress, "refine");
  }
  const auto refine_only = [&](auto&& from) {
    return refine(std::forward<decltype(from)>(from), report.view, display.surface, display.map, options.raster, refine_options, report.refine);
  };
  Scene warped = options.shading == Shading::bake ? refine_and_bake(scene, options, display, std::move(refine_options), report)
                 : owned != nullptr               ? refine_only(std::move(*owned))
                                                  : refine_only(scene);
  warn_of_lines(options.refine, report);
  if (options.shading == Shading::unlit)
    for (Material& material : warped.materials) material.unlit = true;
  if (options.shading == Shading::keep) warped.lights = lights_in_eye_space(scene, report.view, report.warnings);
  report.total_ms = ms_since(start);
  report.peak_memory_mb = static_cast<double>(peak_memory()) / (1 << 20);
  warped.extras = to_json(make_record(options, report));
  return warped;
}

} // namespace

Scene convert(const Scene& scene, const ConvertOptions& options, const Display& display, ConvertReport& report, const Progress& progress) {
  return convert_scene(scene, nullptr, options, display, report, progress);
}

Scene convert(Scene&& scene, const ConvertOptions& options, const Display& display, ConvertReport& report, const Progress& progress) {
  return convert_scene(scene, &scene, options, display, report, progress);
}

bool is_kept(const ConvertReport& report, const ConvertOptions& options) {
  return report.refine.limits_hit.empty() && report.refine.open_edges == 0 && report.packing_turned == 0 &&
         (options.refine.subdivision != Subdivision::adaptive ||
          (report.refine.error_px_max <= options.refine.tolerance_px * (1 + 1e-6) && report.packing_px <= options.refine.tolerance_px));
}

std::string broken_promise(const ConvertReport& report, const ConvertOptions& options) {
  std::ostringstream text;
  text << "the tolerance of " << options.refine.tolerance_px << " px was not kept: certified " << report.refine.error_px_max << " px";
  if (report.packing_px > options.refine.tolerance_px) text << ", rounding in the file moves points by up to " << report.packing_px << " px more";
  if (report.refine.open_edges > 0) text << ", " << report.refine.open_edges << " open edges that the source did not have";
  if (report.packing_turned > 0) text << ", rounding in the file leaves " << report.packing_turned << " triangles turned over";
  for (const std::string& limit : report.refine.limits_hit) text << ", stopped by " << limit;
  return text.str();
}

} // namespace domewarp
