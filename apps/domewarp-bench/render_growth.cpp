// SPDX-License-Identifier: Apache-2.0
#include "render_growth.h"

#include "bench_scenes.h"
#include "child_process.h"
#include "domewarp/convert/convert.h"
#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/scene/raster.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

struct Told {
  double seconds = 0;
  std::size_t bands = 0;
};

SurfaceOptions dome() {
  SurfaceOptions options;
  options.curve = "1-r^2";
  return options;
}

Told trace(const Raster& raster) {
  const Scene scene = bundled("toys");
  const Surface surface(dome(), screen_radius(raster));
  Told told;
  told.seconds = seconds([&] {
    ray_trace(scene, resolve_view(scene, {}), surface, raster, {}, [&](const Frame&, int) { ++told.bands; });
  });
  return told;
}

Told draw(const Raster& raster) {
  ConvertOptions options;
  options.surface = dome();
  options.raster = raster;
  options.refine.source_attributes = true;
  ConvertReport report;
  const Scene warped = convert(bundled("toys"), options, report);
  Told told;
  told.seconds = seconds([&] { rasterise(warped, raster, {}, [&](const Frame&, int) { ++told.bands; }); });
  return told;
}

} // namespace

void measure_pixels(const Options& options, Result& result) {
  Table table{"render_pixels", "toys on 1-r^2, with ids, positions and depth: time and memory against pixels",
              {{"rows", "rows"}, {"pixels", "pixels"}, {"trace_s", "rays s"}, {"trace_peak_mb", "peak MB"}, {"raster_s", "raster s"}, {"raster_peak_mb", "peak MB"}},
              {}};
  Plot time{"render_time", "Both renderers: time against pixels (toys, 1-r^2)", {"pixels", true}, {"seconds", true}, {{"ray traced", {}}, {"rasterised", {}}}};
  Plot memory{"render_memory", "Both renderers: memory against pixels (toys, 1-r^2)", {"pixels", true}, {"peak MB", true}, {{"ray traced", {}}, {"rasterised", {}}}};
  for (const int rows : options.quick ? std::vector<int>{32, 64} : std::vector<int>{256, 512, 1024, 2048, 4096, 8192}) {
    options.progress("both renderers at " + std::to_string(rows) + " rows");
    const Raster raster{rows, rows};
    const double pixels = static_cast<double>(rows) * rows;
    const Measured<Told> traced = in_child([&] { return trace(raster); }), drawn = in_child([&] { return draw(raster); });
    if (traced.bands == 0 || drawn.bands == 0) throw Error(ErrorCode::output, "a renderer delivered no picture: nothing was measured");
    table.rows.push_back({static_cast<double>(rows), pixels, traced.seconds, traced.peak_bytes / 1e6, drawn.seconds, drawn.peak_bytes / 1e6});
    time.series[0].points.emplace_back(pixels, traced.seconds);
    time.series[1].points.emplace_back(pixels, drawn.seconds);
    memory.series[0].points.emplace_back(pixels, traced.peak_bytes / 1e6);
    memory.series[1].points.emplace_back(pixels, drawn.peak_bytes / 1e6);
  }
  result.notes.push_back("Slope of the log-log fit of time against pixels: rays " + three_digits(log_log_slope(time.series[0].points)) + ", raster " +
                         three_digits(log_log_slope(time.series[1].points)) + ".");
  result.tables.push_back(std::move(table));
  result.plots.push_back(std::move(time));
  result.plots.push_back(std::move(memory));
}

} // namespace domewarp::bench
