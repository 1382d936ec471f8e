// SPDX-License-Identifier: Apache-2.0
// Live use: frames per second of warping all vertices for a moving eye; how wrong a refined mesh gets when the eye has left
// the place it was refined for; and what refining it again costs.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <glm/geometric.hpp>

#include "bench_scenes.h"
#include "benches.h"
#include "domewarp/convert/live.h"
#include "domewarp/core/parallel.h"
#include "domewarp/core/quantile.h"
#include "domewarp/scene/test_scenes.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

const Raster raster{4096, 4096};

ConvertOptions dome() {
  ConvertOptions options;
  options.surface.lens = Lens::equidistant;
  options.surface.fov_deg = 180;
  options.raster = raster;
  options.refine.source_attributes = true;
  return options;
}

/// The eye on a small circle, a frame further each time.
View in_frame(const View& view, int frame) {
  const double angle = 2 * std::numbers::pi * frame / 60;
  View moved = view;
  moved.eye += 0.1 * (std::cos(angle) * view.right + std::sin(angle) * view.up);
  return moved;
}

/// The same triangles with three vertices each: what a file without indices costs.
Scene without_indices(Scene scene) {
  for (Mesh& mesh : scene.meshes)
    for (Primitive& primitive : mesh.primitives) {
      std::vector<Vec3f> corners;
      for (const std::uint32_t index : primitive.indices) corners.push_back(primitive.positions[index]);
      primitive.positions = std::move(corners);
    }
  return scene;
}

void copy(const LiveMesh& mesh, std::span<Vec3f> out) {
  parallel_ranges(out.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[i] = 1.5F * mesh.positions[i];
  });
}

void add_frames(const std::string& name, std::size_t triangles, const LiveMesh& mesh, const View& view, const BatchMap& map, int rounds,
                Table& table) {
  std::vector<Vec3f> out(mesh.positions.size());
  int frame = 0;
  const std::vector<std::function<void()>> works{
      [&] { copy(mesh, out); },
      [&] { rewarp(mesh, in_frame(view, frame++), map, BatchOutput::perspective, out); },
      [&] { with_threads(1, [&] { rewarp(mesh, in_frame(view, frame++), map, BatchOutput::perspective, out); }); }};
  const std::vector<double> times = least_seconds(works, rounds);
  table.rows.push_back({name, static_cast<double>(triangles), static_cast<double>(out.size()), 1e3 * times[1], 1 / times[1], 1 / times[2],
                        times[1] / times[0]});
}

struct Drift {
  double most = 0, p99 = 0; ///< pixels
};

/// How far the middles of the drawn edges are from where they belong, of those in sight.
Drift drift(const Scene& warped, const LiveMesh& mesh, const View& view, const BatchMap& map, const Surface& surface,
            const ImageMap& exact) {
  std::vector<Vec3f> out(mesh.positions.size());
  rewarp(mesh, view, map, BatchOutput::perspective, out);
  std::vector<double> errors;
  for (const LivePart& part : mesh.parts) {
    const auto& indices = warped.meshes[warped.instances[part.instance].mesh].primitives[part.primitive].indices;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const std::size_t a = part.first + indices[i], b = part.first + indices[i % 3 == 2 ? i - 2 : i + 1];
      const Vec3 middle = 0.5 * (to_world(part.world, mesh.positions[a]) + to_world(part.world, mesh.positions[b]));
      const ImagePoint exactly = project(surface, exact, to_eye(view, middle));
      if (exactly.state != PointState::visible) continue;
      const Vec3 drawn = Vec3(out[a]) + Vec3(out[b]);
      errors.push_back(glm::length(Vec2(drawn) / -drawn.z - Vec2(exactly.x, exactly.y)) / pixel_size(raster));
    }
  }
  if (errors.empty()) return {};
  return {std::ranges::max(errors), quantile(errors, 100)};
}

void add_moves(const std::string& name, const Scene& scene, const Display& display, Table& table) {
  const ConvertOptions options = dome();
  ConvertReport report;
  Scene warped;
  const double refining = seconds([&] { warped = convert(scene, options, display, report); });
  const LiveMesh mesh = make_live_mesh(warped, report);
  const BatchMap map(display.surface);
  const ImageMap exact = make_image_map(display.surface, Method::direct);
  for (const double distance : {0.0, 0.01, 0.03, 0.1, 0.3, 1.0}) {
    View view = report.view;
    view.eye += distance * glm::normalize(view.right + view.up - view.back);
    const Drift found = drift(warped, mesh, view, map, display.surface, exact);
    table.rows.push_back({name, static_cast<double>(report.refine.triangles_out), 1e3 * refining, distance, found.most, found.p99});
  }
}

Plot draw_moves(const Table& table) {
  Plot plot{"live_moves", "A refined mesh while the eye moves away", {"distance from the eye it was refined for (m)"},
            {"largest error of the middle of an edge (px)"}, {}};
  for (const auto& row : table.rows) {
    const std::string& name = std::get<std::string>(row[0]);
    if (name == "cave") continue; // its triangles are small anyway
    if (plot.series.empty() || plot.series.back().name != name) plot.series.push_back({name, {}});
    plot.series.back().points.emplace_back(std::get<double>(row[3]), std::get<double>(row[4]));
  }
  return plot;
}

} // namespace

Result run_live_bench(const Options& options) {
  const Display display = make_display(dome().surface, raster, Method::automatic);
  const BatchMap map(display.surface);
  Table frames{"live",
               "Warping every vertex for a new eye (equidistant, 180 degrees), nothing else; least time of a frame",
               {{"mesh", "mesh"}, {"triangles", "triangles"}, {"vertices", "vertices"}, {"frame_ms", "frame ms"},
                {"frames_per_s", "frames/s"}, {"frames_per_s_one_thread", "frames/s, 1 thread"}, {"ratio_to_copy", "ratio to copy"}},
               {}};
  Table moves{"live_moves",
              "A mesh refined to 0.5 px of 4096 rows, warped for an eye that has moved: error at the middles of its edges",
              {{"scene", "scene"}, {"triangles", "triangles"}, {"refine_ms", "refine ms"}, {"moved", "eye moved (m)"},
               {"error_px_max", "max px"}, {"error_px_p99", "99 % px"}},
              {}};
  const int rounds = options.quick ? 2 : 60;
  for (const std::size_t size : options.quick ? std::vector<std::size_t>{1000} : std::vector<std::size_t>{100'000, 1'000'000, 4'000'000}) {
    options.progress("live: " + std::to_string(size) + " triangles");
    const Scene scene = cave(size);
    add_frames("cave", count_triangles(scene), make_live_mesh(scene), View{}, map, rounds, frames);
    add_frames("cave, no shared vertex", count_triangles(scene), make_live_mesh(without_indices(scene)), View{}, map, rounds, frames);
  }
  for (const TestScene& test : make_test_scenes()) {
    if (options.quick && test.name != "cubes") continue;
    options.progress("live: refining " + test.name);
    add_moves(test.name, test.scene, display, moves);
  }
  if (!options.quick) {
    options.progress("live: refining a cave of a million triangles");
    add_moves("cave", cave(1'000'000), display, moves);
  }
  return {{frames, moves}, {draw_moves(moves)}, {}};
}

} // namespace domewarp::bench
