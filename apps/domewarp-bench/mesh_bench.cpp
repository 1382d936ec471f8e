// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "bench_scenes.h"
#include "benches.h"
#include "lower_bound.h"
#include "mesh_measure.h"
#include "mesh_rivals.h"
#include "mesh_speed.h"

namespace domewarp::bench {

namespace {

/// Triangles that an uncertified red-green prototype needed for the box at 0.5 px of 4096 rows, perspective output.
constexpr double prototype[] = {12000, 13700, 11100, 7200};

void count_box(const Options& options, Result& result) {
  const Raster raster = options.quick ? Raster{128, 128} : Raster{4096, 4096};
  Table counts{"mesh_counts",
               "The closed box of 12 triangles at 0.5 px of " + std::to_string(raster.height) +
                   " rows, whole visible cone. Goal: an uncertified prototype's count (perspective, 4096 rows), 3 N* (orthographic). Plain: walls of one colour, whose insides are held to the depth alone",
               {{"surface", "surface"}, {"projection", "projection"}, {"triangles", "triangles"}, {"without_depth", "any depth"}, {"depth_alone", "depth alone"}, {"plain", "plain"}, {"goal", "goal"},
                {"of_goal", "of goal"}, {"lower_bound", "N*"}, {"of_lower_bound", "of N*"}, {"evaluations", "evaluations/triangle"}, {"ms", "ms"}},
               {}};
  Table errors{"mesh_errors",
               "Certified and true error of the same meshes, px: 63 points of every edge, 66 of every face",
               {{"surface", "surface"}, {"projection", "projection"}, {"edges", "edges"}, {"certified_px", "certified"},
                {"edge_px", "true, edges"}, {"face_px", "true, faces"}, {"median_ratio", "median certified/true"},
                {"tight_ratio", "of edges above half the tolerance"}, {"edge_violations", "edge violations"}, {"face_violations", "face violations"},
                {"uncertified_faces", "judged by samples"}},
               {}};
  const auto all = surfaces();
  for (std::size_t s = 0; s < all.size(); ++s) {
    const Display display = make_display(all[s].first, all[s].second, raster);
    const double least = least_triangles(box(), display.exact.branches.front(), 0.5 * pixel_size(raster), options.quick ? 6 : 24);
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
      const bool perspective = projection == Projection::perspective;
      const std::string name = perspective ? "perspective" : "orthographic";
      options.progress("box: " + display.name + ", " + name);
      RefineOptions refine;
      refine.projection = projection;
      const Refined refined = refine_whole(make_soup(box(), View{}, {}), display, raster, refine);
      RefineOptions any_depth = refine;
      any_depth.depth_tolerance = 1e30;
      const auto triangles = static_cast<double>(refined.mesh.faces.size());
      RefineOptions depth_alone = refine; // what a box without texture and light would need at least
      depth_alone.tolerance_px = 1e6;
      RefineOptions plain = refine;
      plain.plain_tolerance_px = 64;
      const auto count = [&](const RefineOptions& o) { return static_cast<double>(refine_whole(make_soup(box(), View{}, {}), display, raster, o).mesh.faces.size()); };
      const double none = std::numeric_limits<double>::quiet_NaN(), goal = options.quick ? none : perspective ? prototype[s] : 3 * least;
      counts.rows.push_back({display.name, name, triangles, count(any_depth), count(depth_alone), count(plain), goal, triangles / goal, perspective ? none : least, perspective ? none : triangles / least,
                             static_cast<double>(refined.mesh.evaluations) / triangles, 1000 * refined.seconds});
      const Judged judged = judge(refined, display, raster, refine);
      errors.rows.push_back({display.name, name, double(judged.edges), judged.certified, judged.edge_error, judged.face_error, judged.median_ratio,
                             judged.tight_ratio, double(judged.edge_violations), double(judged.face_violations), double(refined.mesh.uncertified_faces)});
    }
  }
  result.tables.push_back(std::move(counts));
  result.tables.push_back(std::move(errors));
}

Plot draw_rivals(const Table& table) {
  Plot plot{"mesh_rivals", "Triangles at equal measured error", {"adaptive", true}, {"rival", true}, {{"by length", {}, false}, {"uniform", {}, false}, {"equal", {}, true}}};
  double most = 10;
  for (const auto& row : table.rows) {
    const double adaptive = std::get<double>(row[3]);
    plot.series[0].points.emplace_back(adaptive, std::get<double>(row[5]));
    plot.series[1].points.emplace_back(adaptive, std::get<double>(row[8]));
    most = std::max(most, adaptive);
  }
  plot.series[2].points = {{10, 10}, {most, most}};
  return plot;
}

/// Triangles (quantity 0) or time (1) of the ways to refine, against the error they end with.
Plot draw_tolerances(const Table& table, int quantity) {
  const bool time = quantity == 1;
  Plot plot{time ? "mesh_time_error" : "mesh_triangles_error",
            time ? "Refinement: time against error (box, 1-r^2)" : "Refinement: triangles against error (box, 1-r^2)",
            {"largest error (px of 1024 rows)", true},
            {time ? "ms" : "triangles", true},
            {{"adaptive, certified", {}}, {"by length (the thesis)", {}}, {"uniform", {}}, {"adaptive, orthographic", {}}}};
  if (!time) plot.series.push_back({"N*, orthographic", {}});
  const auto value = [](const Cell& cell) { return std::get<double>(cell); };
  const auto reached = [](const Cell& cell) { return std::get<std::string>(cell) == "yes"; };
  for (const auto& row : table.rows) {
    const double error = value(row[1]);
    plot.series[0].points.emplace_back(error, value(row[2 + quantity]));
    if (reached(row[6])) plot.series[1].points.emplace_back(error, value(row[4 + quantity]));
    if (reached(row[9])) plot.series[2].points.emplace_back(error, value(row[7 + quantity]));
    plot.series[3].points.emplace_back(value(row[10]), value(row[11 + quantity]));
    if (!time) plot.series[4].points.emplace_back(value(row[0]), value(row[13]));
  }
  return plot;
}

} // namespace

Result run_mesh_bench(const Options& options) {
  Result result;
  measure_growth(options, result); // starts processes, so before any thread runs
  count_box(options, result);
  result.tables.push_back(compare_with_rivals(options));
  result.plots.push_back(draw_rivals(result.tables.back()));
  result.tables.push_back(sweep_tolerances(options));
  for (const int quantity : {0, 1}) result.plots.push_back(draw_tolerances(result.tables.back(), quantity));
  result.tables.push_back(measure_skips(options));
  return result;
}

} // namespace domewarp::bench
