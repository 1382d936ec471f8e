// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/refine.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/memory.h"
#include "domewarp/core/parallel.h"
#include "domewarp/refine/emit.h"
#include "domewarp/refine/levels.h"
#include "domewarp/refine/lines.h"
#include "domewarp/refine/plain_faces.h"
#include "domewarp/refine/soup.h"
#include "domewarp/refine/picture_rectangle.h"
#include "domewarp/refine/tolerances.h"

namespace domewarp {

namespace {

class Stopwatch {
public:
  /// Milliseconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return ms;
  }

private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void check(const RefineOptions& options) {
  const auto positive = [](double value, const char* option) {
    if (!(value > 0) || !std::isfinite(value))
      throw Error(ErrorCode::usage, std::string(option) + ": must be a positive number, got " + std::to_string(value));
  };
  positive(options.tolerance_px, "--tolerance");
  const auto looser = [&](double value, double than, const char* option, const char* other) {
    if (value == 0) return;
    positive(value, option);
    if (value < than) throw Error(ErrorCode::usage, std::string(option) + ": must not be below " + other + " (" + std::to_string(than) + "), got " + std::to_string(value));
  };
  looser(options.texture_tolerance_px, options.tolerance_px, "--texture-tolerance", "--tolerance");
  looser(options.plain_tolerance_px, std::max(options.tolerance_px, options.texture_tolerance_px), "--plain-tolerance", "--texture-tolerance");
  positive(options.depth_tolerance, "--depth-tolerance");
  positive(options.isotropic.threshold, "--threshold");
  if (options.isotropic.max_lod < 0 || options.isotropic.max_lod > 12)
    throw Error(ErrorCode::usage, "--max-lod: must be from 0 to 12, got " + std::to_string(options.isotropic.max_lod));
  if (options.near != 0) positive(options.near, "--near");
  if (options.criterion) positive(options.criterion_px, "criterion_px");
  if (options.weld != 0) positive(options.weld, "--weld");
}

double extent(const Soup& soup) {
  constexpr std::size_t block_size = 16384;
  std::vector<double> farthest2((soup.faces.size() + block_size - 1) / block_size, 0);
  parallel_each(farthest2.size(), 1, [&](std::size_t block) {
    for (std::size_t f = block * block_size; f < std::min(soup.faces.size(), (block + 1) * block_size); ++f)
      for (const std::uint32_t point : points_of(soup, soup.faces[f]))
        farthest2[block] = std::max(farthest2[block], glm::dot(soup.points[point], soup.points[point]));
  });
  return farthest2.empty() ? 0 : std::sqrt(*std::max_element(farthest2.begin(), farthest2.end()));
}

/// Refines within the limit: where the tolerance needs more triangles, every edge gets the same larger one, the
/// smallest (to a factor of 1.2) that fits. Such a mesh is marked as stopped. When none fits, because the clip alone
/// needs more, refinement ends where the limit was reached.
RefinedMesh refine_within(const Soup& soup, const EdgeOracle& oracle, const LevelOptions& options) {
  RefinedMesh mesh = refine_levels(soup, oracle, options);
  if (!mesh.stopped) return mesh;
  constexpr double hopeless = 1e8;
  double high = 1;
  std::optional<RefinedMesh> best;
  while (!best && high < hopeless) {
    high *= 4;
    if (RefinedMesh tried = refine_levels(soup, oracle.relaxed(high), options); !tried.stopped) best = std::move(tried);
  }
  if (!best) return mesh;
  for (double low = high / 4; high > 1.2 * low;) {
    const double middle = std::sqrt(low * high);
    RefinedMesh tried = refine_levels(soup, oracle.relaxed(middle), options);
    (tried.stopped ? low : high) = middle;
    if (!tried.stopped) best = std::move(tried);
  }
  best->stopped = true;
  return std::move(*best);
}

/// What is carried over as it is; meshes are filled in branch by branch.
Scene empty_copy(const Scene& scene) {
  Scene out;
  out.name = scene.name;
  out.materials = scene.materials;
  out.textures = scene.textures;
  out.images = scene.images;
  out.samplers = scene.samplers;
  out.copyright = scene.copyright;
  out.asset_extras = scene.asset_extras;
  out.scene_extras = scene.scene_extras;
  out.root_extras = scene.root_extras;
  for (int i = 0; i < static_cast<int>(scene.instances.size()); ++i) {
    const Instance& instance = scene.instances[i];
    out.meshes.push_back({scene.meshes[instance.mesh].name, {}, scene.meshes[instance.mesh].extras});
    out.instances.push_back({instance.name, i, Mat4(1), instance.extras});
  }
  return out;
}

void note_lines(const LineCounts& lines, RefineReport& report) {
  report.lines_in = lines.lines;
  report.points_in = lines.points;
}

/// All branches at once: each point appears on the first that shows it.
void refine_isotropic(const Scene& scene, const View& view, const Surface& surface, const ImageMap& map, const Raster& raster,
                      const RefineOptions& options, Scene& out, RefineReport& report) {
  Stopwatch watch;
  const Soup soup = make_loose_soup(scene, view);
  report.triangles_in = soup.source_triangles;
  note_lines(count_lines(scene, view), report);
  report.near = options.near > 0 ? options.near : std::max(1e-5 * extent(soup), 1e-30);
  report.soup_ms = watch.lap();
  const RefinedMesh mesh = subdivide_isotropic(soup, surface, map, options.projection, options.isotropic, options.max_triangles, report.isotropic);
  report.levels = mesh.levels;
  report.map_evaluations = mesh.evaluations;
  report.triangles_clipped = report.isotropic.invisible;
  if (report.isotropic.stopped) report.limits_hit.push_back("max-triangles");
  report.error_px_max = report.error_px_p99 = report.error_px_mean = report.depth_error_max = std::numeric_limits<double>::quiet_NaN();
  report.levels_ms = watch.lap();
  emit(scene, view, soup, mesh, map.branches.front().branch().orientation, raster, options, out, report);
  report.emit_ms = watch.lap();
}

/// @param release called once the triangles' positions and indices are no longer needed
Scene refine_and_release(const Scene& scene, const View& view, const Surface& surface, const ImageMap& map, const Raster& raster,
                         const RefineOptions& options, RefineReport& report, const std::function<void()>& release) {
  check(options);
  Scene out = empty_copy(scene);
  if (options.subdivision == Subdivision::isotropic) {
    refine_isotropic(scene, view, surface, map, raster, options, out, report);
    out.cameras = {picture_camera(raster, options.projection, report.smallest_depth, report.largest_depth)};
    return out;
  }
  Stopwatch watch;
  const Vec2 half_extent = kept_half_extent(options, raster);
  const ViewCull cull(surface, half_extent);
  Soup soup = make_soup(scene, view, {options.skip.back_faces, options.weld, options.skip.outside_view ? &cull : nullptr});
  report.triangles_in = soup.source_triangles;
  report.skipped.outside_view = soup.outside_view;
  report.skipped.degenerate = soup.degenerate_triangles;
  report.skipped.back_faces = soup.back_faces;
  report.near_misses = soup.near_misses;
  report.snapped = soup.snapped;
  report.t_junctions_in = soup.t_junctions;
  report.open_edges_in = soup.open_edges;
  const LineCounts lines = count_lines(scene, view);
  note_lines(lines, report);
  report.near = options.near > 0 ? options.near : std::max(1e-5 * std::max(extent(soup), lines.extent), 1e-30);
  release();
  report.soup_ms = watch.lap();

  std::vector<std::uint8_t> plain;
  if (options.plain_tolerance_px > std::max(options.tolerance_px, options.texture_tolerance_px)) plain = find_plain_faces(scene, soup, options);
  report.plain_faces = static_cast<std::size_t>(std::count(plain.begin(), plain.end(), 1));

  for (std::size_t b = 0; b < map.branches.size(); ++b) {
    const BranchMap& branch = map.branches[b];
    const EdgeOracle oracle(surface, b, branch, make_visible_region(branch.branch(), report.near), oracle_options(options, raster));
    const PictureCull off_picture(branch, half_extent);
    RefinedMesh refined = refine_within(soup, oracle, {options.max_triangles, options.skip.off_picture ? &off_picture : nullptr, options.skip.small_faces, plain});
    report.skipped.off_picture += refined.off_picture;
    report.skipped.small_faces += refined.whole.size();
    report.levels = std::max(report.levels, refined.levels);
    report.map_evaluations += refined.evaluations;
    report.triangles_clipped += refined.clipped;
    report.uncertified_faces += refined.uncertified_faces;
    if (refined.stopped) report.limits_hit.push_back("max-triangles");
    if (b + 1 == map.branches.size()) free_vector(soup.points); // they stand in `refined`, too
    report.levels_ms += watch.lap();
    audit_edges(refined, oracle, raster, options, report);
    free_vector(refined.edges); // the largest part, and nobody asks any more
    emit(scene, view, soup, refined, branch.branch().orientation, raster, options, out, report);
    emit_lines(scene, view, oracle, raster, options, out, report);
    report.emit_ms += watch.lap();
  }
  out.cameras = {picture_camera(raster, options.projection, report.smallest_depth, report.largest_depth)};
  return out;
}

} // namespace

Scene refine(const Scene& scene, const View& view, const Surface& surface, const ImageMap& map, const Raster& raster,
             const RefineOptions& options, RefineReport& report) {
  return refine_and_release(scene, view, surface, map, raster, options, report, [] {});
}

Scene refine(Scene&& scene, const View& view, const Surface& surface, const ImageMap& map, const Raster& raster,
             const RefineOptions& options, RefineReport& report) {
  std::vector<Image> images = std::exchange(scene.images, {});
  Scene out = refine_and_release(scene, view, surface, map, raster, options, report, [&] {
    std::size_t freed = 0;
    for (Mesh& mesh : scene.meshes)
      for (Primitive& primitive : mesh.primitives) {
        if (primitive.topology != Topology::triangles) continue;
        freed += primitive.positions.size() * sizeof(Vec3f) + primitive.indices.size() * sizeof(std::uint32_t);
        free_vector(primitive.positions);
        free_vector(primitive.indices);
      }
    constexpr std::size_t worth_returning = 8 << 20; // small blocks come in handy for what follows
    if (freed >= worth_returning) release_free_memory();
  });
  out.images = std::move(images);
  return out;
}

} // namespace domewarp
