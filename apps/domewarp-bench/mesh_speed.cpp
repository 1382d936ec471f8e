// SPDX-License-Identifier: Apache-2.0
#include "mesh_speed.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>

#include "bench_scenes.h"
#include "child_process.h"
#include "domewarp/convert/read_attributes.h"
#include "domewarp/core/parallel.h"
#include "domewarp/scene/test_scenes.h"
#include "mesh_measure.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

struct Told {
  double seconds = 0, refine_seconds = 0; ///< of the whole stage, of its refinement alone
  double cpu_seconds = 0;                 ///< of all threads, which a busy machine lengthens less
  std::size_t triangles = 0;
};

struct Job {
  std::string name;
  SurfaceOptions surface;
  RefineOptions refine;
  Raster raster{4096, 4096};
};

/// The least times of a few rounds on two threads.
Told run(const Scene& scene, const Job& job, int rounds) {
  const ThreadLimit two(2);
  const Display display = make_display(job.name, job.surface, job.raster);
  constexpr double forever = std::numeric_limits<double>::infinity();
  Told told{forever, forever, forever, 0};
  for (int round = 0; round < rounds; ++round) {
    RefineReport report;
    Scene out;
    const std::clock_t cpu = std::clock();
    const double time = seconds([&] { out = refine(scene, View{}, display.surface, display.map, job.raster, job.refine, report); });
    told.cpu_seconds = std::min(told.cpu_seconds, static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC);
    told.seconds = std::min(told.seconds, time);
    told.refine_seconds = std::min(told.refine_seconds, report.levels_ms / 1000);
    told.triangles = report.triangles_out;
  }
  return told;
}

} // namespace

void measure_growth(const Options& options, Result& result) {
  Table table{"mesh_speed",
              "Refinement on two threads, least of 3: the box split finer and finer, and a cave of triangles that need no split",
              {{"work", "work"}, {"tolerance_px", "tolerance px"}, {"triangles_out", "triangles out"}, {"seconds", "s"},
               {"rate", "triangles/s"}, {"refine_rate", "of refinement alone"}, {"cpu_rate", "triangles per CPU second"}, {"peak_mb", "peak MB"}, {"bytes_per_triangle", "bytes/triangle"}},
              {}};
  Plot plot{"mesh_growth", "Refinement of the box, two threads", {"triangles out", true}, {"", true}, {{"CPU seconds", {}}, {"peak MB / 1000", {}}}};
  const auto add = [&](const std::string& name, const Job& job, const Measured<Told>& told) {
    const auto triangles = static_cast<double>(told.triangles);
    table.rows.push_back({name, job.refine.tolerance_px, triangles, told.seconds, triangles / told.seconds, triangles / told.refine_seconds, triangles / told.cpu_seconds,
                          told.peak_bytes / 1e6, told.peak_bytes / triangles});
  };
  std::vector<Vec2> times, memory;
  const std::vector<double> tolerances = options.quick ? std::vector<double>{4, 2} : std::vector<double>{0.5, 0.15, 0.05, 0.015, 0.005, 0.0015};
  Job job{"1-r^2", surfaces()[1].second, {}};
  for (const double tolerance : tolerances) {
    options.progress("growth: " + three_digits(tolerance) + " px");
    job.refine.tolerance_px = tolerance;
    const Measured<Told> told = in_child([&] { return run(box(), job, tolerance < 0.01 ? 1 : 3); });
    add("box, 1-r^2", job, told);
    const auto triangles = static_cast<double>(told.triangles);
    times.emplace_back(triangles, told.cpu_seconds);
    memory.emplace_back(triangles, told.peak_bytes);
    plot.series[0].points.emplace_back(triangles, told.cpu_seconds);
    plot.series[1].points.emplace_back(triangles, told.peak_bytes / 1e9);
  }
  options.progress("triangles that need no split");
  job.refine.tolerance_px = 0.5;
  job.raster = {256, 256};
  const std::size_t many = options.quick ? 2000 : 2'000'000;
  add("cave, no split", job, in_child([&] { return run(cave(many), job, 3); }));
  result.tables.push_back(std::move(table));
  result.plots.push_back(std::move(plot));
  result.notes.push_back("Slope of the log-log fit over " + three_digits(times.front().x) + " to " + three_digits(times.back().x) + " triangles: CPU time " +
                         three_digits(log_log_slope(times)) + ", peak memory " + three_digits(log_log_slope(memory)) + ".");
}

Table measure_skips(const Options& options) {
  const Raster raster = options.quick ? Raster{256, 256} : Raster{4096, 4096};
  const int rounds = options.quick ? 1 : 5;
  Table table{"mesh_skips",
              "What each kind of skipping saves (equidistant 180, 0.5 px of " + std::to_string(raster.height) + " rows, least of " + std::to_string(rounds) + ")",
              {{"scene", "scene"}, {"no_skip", "left out"}, {"triangles_out", "triangles out"}, {"vertices", "vertices"},
               {"attribute_bytes", "attribute bytes"}, {"evaluations", "map evaluations"}, {"ms", "ms"}, {"time_ratio", "time / all"}},
              {}};
  const Display display = make_display(surfaces()[0].first, surfaces()[0].second, raster);
  for (const TestScene& test : make_test_scenes()) {
    options.progress("skips: " + test.name);
    const View view = resolve_view(test.scene, {});
    double all_ms = 0;
    const auto add = [&](const std::string& name, const RefineOptions& refine_options) {
      double ms = std::numeric_limits<double>::infinity();
      RefineReport report;
      Scene out;
      for (int round = 0; round < rounds; ++round) {
        report = {};
        ms = std::min(ms, 1000 * seconds([&] { out = refine(test.scene, view, display.surface, display.map, raster, refine_options, report); }));
      }
      if (all_ms == 0) all_ms = ms;
      double bytes = 0;
      for (const Mesh& mesh : out.meshes)
        for (const Primitive& primitive : mesh.primitives)
          for (const Attribute& attribute : primitive.attributes) bytes += 4.0 * static_cast<double>(attribute.values.size());
      table.rows.push_back({test.name, name, double(report.triangles_out), double(report.vertices), bytes, double(report.map_evaluations), ms, ms / all_ms});
    };
    RefineOptions everything;
    everything.reads = attribute_reader(test.scene, false);
    add("nothing", everything);
    for (const SkipName& skip : skip_names) {
      RefineOptions without = everything;
      without.skip.*skip.member = false;
      add(skip.name, without);
    }
  }
  return table;
}

} // namespace domewarp::bench
