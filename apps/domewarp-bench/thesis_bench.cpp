// SPDX-License-Identifier: Apache-2.0
// The measurements of the founding thesis, repeated: its two ways to transform points beside ours, and its subdivision
// beside ours. Its scenes are lost; ours have its counts of objects and triangles.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include <glm/geometric.hpp>

#include "benches.h"
#include "domewarp/core/parallel.h"
#include "domewarp/core/quantile.h"
#include "domewarp/refine/refine.h"
#include "domewarp/refine/soup.h"
#include "domewarp/scene/test_scenes.h"
#include "domewarp/transform/batch.h"
#include "thesis_methods.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
const Raster raster{1024, 1024};
constexpr std::array<const char*, 3> curves{"1-r", "-r*r*r+r*r+r+1", "3-sqrt(4+6*r*r)"}; // Eq. 26

/// Table 2: frames per second on a Pentium III at 450 MHz with a Voodoo3, drawing included.
struct Printed2 {
  const char* scene;
  std::array<double, 3> direct, table;
};
constexpr std::array<Printed2, 5> table_2{{{"cubes", {60.8, 51.8, 32.0}, {60.3, 60.4, 60.4}},
                                           {"pool", {18.0, 8.7, 5.4}, {60.3, 60.3, 60.3}},
                                           {"hardware", {7.5, 3.6, 2.2}, {33.4, 33.2, 33.6}},
                                           {"toys", {5.2, 2.5, 1.6}, {22.4, 22.4, 22.4}},
                                           {"biology", {2.1, 1.0, 0.6}, {9.3, 9.3, 9.3}}}};

/// Table 3: points by level of detail.
constexpr std::array<double, 10> points_at_01{20802, 23034, 24714, 26550, 27534, 28278, 29238, 30198, 31158, 32118};
constexpr std::array<double, 10> points_at_02{20802, 21870, 22974, 23778, 24114, 24594, 25122, 25650, 26178, 26706};

Surface surface_of(const char* curve) {
  SurfaceOptions options;
  options.curve = curve;
  return Surface(options, screen_radius(raster));
}

struct Vertices {
  std::vector<float> in, out;
  std::size_t count() const { return in.size() / 3; }
  ConstPoints from() const { return {in.data(), in.data() + count(), in.data() + 2 * count(), 1}; }
  Points to() { return {out.data(), out.data() + count(), out.data() + 2 * count(), 1}; }
};

/// Three vertices per triangle, in eye space: what the thesis transforms for a frame.
Vertices vertices_of(const Scene& scene) {
  const Soup soup = make_loose_soup(scene, resolve_view(scene, {}));
  Vertices vertices;
  for (int axis = 0; axis < 3; ++axis)
    for (const SoupFace& face : soup.faces)
      for (const std::uint32_t point : points_of(soup, face)) vertices.in.push_back(static_cast<float>(soup.points[point][axis]));
  vertices.out.resize(vertices.in.size());
  return vertices;
}

void map_by_perspective(const ConstPoints& in, const Points& out, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float per_depth = -1 / in.z[i];
    out.x[i] = in.x[i] * per_depth;
    out.y[i] = in.y[i] * per_depth;
    out.z[i] = -in.z[i];
  }
}

/// Frames per second of each way, the best of some rounds in which all take turns. Short work is repeated.
std::vector<double> frames_per_second(const std::vector<std::function<void()>>& ways, int rounds) {
  constexpr double long_enough = 2e-3; // seconds
  std::vector<double> repeats;
  std::vector<std::function<void()>> works;
  for (const auto& way : ways) {
    way();
    repeats.push_back(std::max(1.0, std::ceil(long_enough / seconds(way))));
    works.emplace_back([&way, times = static_cast<int>(repeats.back())] {
      for (int i = 0; i < times; ++i) way();
    });
  }
  std::vector<double> rates = least_seconds(works, rounds);
  for (std::size_t i = 0; i < rates.size(); ++i) rates[i] = repeats[i] / rates[i];
  return rates;
}

struct Frames {
  std::string scene, curve;
  double vertices;
  double thesis_direct, thesis_table, our_direct, our_table, printed_direct, printed_table;
};

Frames measure_frames(const Printed2& printed, std::size_t c, Vertices& vertices, int rounds) {
  const Surface surface = surface_of(curves[c]);
  const Curve curve = make_curve(curves[c]);
  const ThesisTable table = make_thesis_table(curve, surface.r_max());
  BatchOptions directly;
  directly.method = Method::direct;
  const BatchMap ours(surface), exact(surface, directly);
  const std::size_t count = vertices.count();
  const std::vector<double> rates = frames_per_second(
      {[&] { map_by_bisection(curve, surface.r_max(), vertices.from(), vertices.to(), count); },
       [&] { map_by_thesis_table(table, vertices.from(), vertices.to(), count); },
       [&] { exact.map(vertices.from(), vertices.to(), count, BatchOutput::image); },
       [&] { ours.map(vertices.from(), vertices.to(), count, BatchOutput::image); }},
      rounds);
  return {printed.scene, "Curve " + std::to_string(c + 1), static_cast<double>(count), rates[0], rates[1], rates[2], rates[3],
          printed.direct[c], printed.table[c]};
}

Frames measure_perspective(const Printed2& printed, Vertices& vertices, int rounds) {
  const std::size_t count = vertices.count();
  const double rate = frames_per_second({[&] { map_by_perspective(vertices.from(), vertices.to(), count); }}, rounds)[0];
  return {printed.scene, "none (perspective)", static_cast<double>(count), rate, rate, rate, rate, nothing, nothing};
}

std::vector<Frames> measure_table_2(const Options& options, const std::vector<TestScene>& scenes) {
  const int rounds = options.quick ? 1 : 7;
  std::vector<Frames> rows;
  for (const Printed2& printed : table_2) {
    options.progress(std::string("thesis: Table 2, ") + printed.scene);
    const auto found = std::ranges::find(scenes, printed.scene, &TestScene::name);
    Vertices vertices = vertices_of(found->scene);
    for (std::size_t c = 0; c < curves.size(); ++c) rows.push_back(measure_frames(printed, c, vertices, rounds));
    rows.push_back(measure_perspective(printed, vertices, rounds));
  }
  return rows;
}

Table tabulate(const std::vector<Frames>& rows) {
  Table table{"thesis_table_2",
              "Table 2: frames per second of re-projecting every vertex on one thread; in 2001, drawing included",
              {{"scene", "scene"}, {"curve", "curve"}, {"vertices", "vertices"}, {"thesis_direct_fps", "thesis direct"},
               {"thesis_table_fps", "thesis table"}, {"direct_fps", "our direct"}, {"table_fps", "our table"},
               {"thesis_ratio", "thesis table/direct"}, {"ratio", "our table/direct"}, {"table_gain", "our/thesis table"},
               {"direct_gain", "our/thesis direct"}, {"printed_direct_fps", "2001 direct"}, {"printed_table_fps", "2001 table"},
               {"printed_ratio", "2001 table/direct"}},
              {}};
  for (const Frames& row : rows)
    table.rows.push_back({row.scene, row.curve, row.vertices, row.thesis_direct, row.thesis_table, row.our_direct, row.our_table,
                          row.thesis_table / row.thesis_direct, row.our_table / row.our_direct, row.our_table / row.thesis_table,
                          row.our_direct / row.thesis_direct, row.printed_direct, row.printed_table, row.printed_table / row.printed_direct});
  return table;
}

struct Drawn {
  const char* name;
  double Frames::*rate;
};

/// One line per way and curve over the vertices of the scenes.
Plot draw_frames(const std::string& name, const std::string& title, const std::vector<Frames>& rows,
                 std::span<const Drawn> ways) {
  Plot plot{name, title, {"vertices transformed per frame", true}, {"frames per second", true}, {}};
  const auto add = [&](const std::string& label, const std::string& curve, double Frames::*rate) {
    Series series{label, {}};
    for (const Frames& row : rows)
      if (row.curve == curve) series.points.emplace_back(row.vertices, row.*rate);
    plot.series.push_back(std::move(series));
  };
  for (const Drawn& way : ways)
    for (int c = 1; c <= 3; ++c) add(std::string(way.name) + ", Curve " + std::to_string(c), "Curve " + std::to_string(c), way.rate);
  add("perspective only", "none (perspective)", &Frames::our_table);
  return plot;
}

/// Largest and 99th percentile distance, in pixels, between where the drawn triangles show points of the scene and where they
/// belong: 12 points of each triangle whose corners are in sight. Triangles that lose a corner are not held against anyone.
struct DrawnError {
  double most = 0, p99 = 0;
};

struct Corners {
  std::array<Vec3, 3> source, drawn;
};

Vec2 shown(const Corners& corners, const Vec3& weights, Projection projection) {
  const Vec3 p = weights[0] * corners.drawn[0] + weights[1] * corners.drawn[1] + weights[2] * corners.drawn[2];
  return projection == Projection::perspective ? Vec2(p) / -p.z : Vec2(p);
}

void judge(const Corners& corners, Projection projection, const Surface& surface, const ImageMap& exact, std::vector<double>& errors) {
  const auto in_sight = [&](const Vec3& p) { return project(surface, exact, p).state == PointState::visible; };
  if (!std::ranges::all_of(corners.source, in_sight)) return;
  constexpr int parts = 4;
  for (int i = 0; i < parts; ++i)
    for (int j = i == 0 ? 1 : 0; j < parts && i + j <= parts; ++j) {
      const Vec3 weights = Vec3(i, j, parts - i - j) / static_cast<double>(parts);
      const Vec3 p = weights[0] * corners.source[0] + weights[1] * corners.source[1] + weights[2] * corners.source[2];
      const ImagePoint belongs = project(surface, exact, p);
      if (belongs.state == PointState::visible)
        errors.push_back(glm::length(shown(corners, weights, projection) - Vec2(belongs.x, belongs.y)) / pixel_size(raster));
    }
}

DrawnError drawn_error(const Scene& warped, Projection projection, const Surface& surface, const ImageMap& exact) {
  std::vector<double> errors;
  for (const Mesh& mesh : warped.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
      for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        Corners corners;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t v = primitive.indices[i + k];
          corners.source[k] = Vec3(source[3 * v], source[3 * v + 1], source[3 * v + 2]);
          corners.drawn[k] = Vec3(primitive.positions[v]);
        }
        judge(corners, projection, surface, exact, errors);
      }
    }
  if (errors.empty()) return {};
  return {std::ranges::max(errors), quantile(errors, 100)};
}

struct Refined {
  RefineReport report;
  DrawnError error;
};

struct Stage {
  const Scene& scene;
  View view;
  Surface surface;
  ImageMap map, exact;

  Refined refined(RefineOptions options) const {
    options.source_attributes = true;
    options.skip.back_faces = options.skip.outside_view = false; // the thesis leaves nothing out
    options.depth_tolerance = 1e3;                               // nor does it bound the depth
    Refined result;
    const Scene warped = refine(scene, view, surface, map, raster, options, result.report);
    result.error = drawn_error(warped, options.projection, surface, exact);
    return result;
  }
};

RefineOptions isotropic(double threshold, int lod, Projection projection) {
  RefineOptions options;
  options.subdivision = Subdivision::isotropic;
  options.isotropic = {threshold, lod};
  options.projection = projection;
  return options;
}

RefineOptions adaptive(double tolerance_px) {
  RefineOptions options;
  options.tolerance_px = tolerance_px;
  return options;
}

struct Level {
  double threshold;
  int lod;
  double printed; ///< points in 2001
};

std::vector<Level> levels_of_table_3(bool quick) {
  std::vector<Level> levels;
  for (const double threshold : {0.1, 0.2})
    for (int lod = 0; lod <= 9; lod += quick ? 9 : 1)
      levels.push_back({threshold, lod, (threshold == 0.1 ? points_at_01 : points_at_02)[static_cast<std::size_t>(lod)]});
  return levels;
}

/// Frames per second of dividing and transforming all triangles, the levels taking turns.
std::vector<double> time_levels(const Stage& stage, const std::vector<Level>& levels, int rounds) {
  const Soup soup = make_loose_soup(stage.scene, stage.view);
  std::vector<std::function<void()>> ways;
  for (const Level& level : levels)
    ways.emplace_back([&] {
      const RefineOptions options = isotropic(level.threshold, level.lod, Projection::orthographic);
      IsotropicReport report;
      subdivide_isotropic(soup, stage.surface, stage.map, options.projection, options.isotropic, options.max_triangles, report);
    });
  return frames_per_second(ways, rounds);
}

std::vector<Cell> measure_level(const Stage& stage, const Level& level, double rate) {
  const Refined flat = stage.refined(isotropic(level.threshold, level.lod, Projection::orthographic));
  const Refined weighted = stage.refined(isotropic(level.threshold, level.lod, Projection::perspective));
  const Refined same = stage.refined(adaptive(weighted.error.most)), better = stage.refined(adaptive(weighted.error.most / 4));
  const auto number = [](std::size_t count) { return static_cast<double>(count); };
  return {level.threshold, static_cast<double>(level.lod), level.printed, number(flat.report.isotropic.points), rate,
          number(flat.report.triangles_out), flat.error.most, weighted.error.most, weighted.error.p99,
          number(same.report.map_evaluations), number(same.report.triangles_out), same.error.most,
          number(better.report.map_evaluations), number(better.report.triangles_out), better.error.most};
}

Table measure_table_3(const Options& options, const Scene& toys) {
  Table table{"thesis_table_3",
              "Table 3: points by level of detail, toys on Curve 2, 1024 rows; adaptive refinement for the same and a quarter of the error",
              {{"threshold", "threshold"}, {"lod", "LOD"}, {"printed_points", "2001 points"}, {"points", "points"},
               {"frames_per_s", "frames/s"}, {"triangles", "triangles"}, {"error_px_flat", "max px, flat"}, {"error_px", "max px"},
               {"error_px_p99", "99 % px"}, {"same_points", "same error: points"}, {"same_triangles", "triangles"},
               {"same_error_px", "max px"}, {"better_points", "1/4 error: points"}, {"better_triangles", "triangles"},
               {"better_error_px", "max px"}},
              {}};
  const Surface surface = surface_of(curves[1]);
  const Stage stage{toys, resolve_view(toys, {}), surface, make_image_map(surface, Method::table), make_image_map(surface, Method::direct)};
  const std::vector<Level> levels = levels_of_table_3(options.quick);
  options.progress("thesis: Figure 25");
  const std::vector<double> rates = time_levels(stage, levels, options.quick ? 1 : 15);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    options.progress("thesis: Table 3, level " + std::to_string(levels[i].lod));
    table.rows.push_back(measure_level(stage, levels[i], rates[i]));
  }
  return table;
}

/// Columns of Table 3 over the level of detail, one line per threshold.
void add_levels(Plot& plot, const Table& table, std::size_t column, const std::string& name) {
  for (const double threshold : {0.1, 0.2}) {
    Series series{name + ", threshold " + (threshold == 0.1 ? "0.1" : "0.2"), {}};
    for (const auto& row : table.rows)
      if (std::get<double>(row[0]) == threshold) series.points.emplace_back(std::get<double>(row[1]), std::get<double>(row[column]));
    plot.series.push_back(std::move(series));
  }
}

std::vector<Plot> draw_table_3(const Table& table) {
  Plot rate{"thesis_figure_25", "Figure 25: frame rate by level of detail (toys, Curve 2, one thread)", {"level of detail"},
            {"frames per second"}, {}};
  add_levels(rate, table, 4, "isotropic");
  Plot points{"thesis_table_3_points", "Table 3: points transformed per frame (toys, Curve 2)", {"level of detail"},
              {"points"}, {}};
  add_levels(points, table, 2, "2001");
  add_levels(points, table, 3, "isotropic");
  add_levels(points, table, 9, "adaptive, same error");
  add_levels(points, table, 12, "adaptive, 1/4 error");
  return {rate, points};
}

} // namespace

Result run_thesis_bench(const Options& options) {
  const ThreadLimit one(1);
  const std::vector<TestScene> scenes = make_test_scenes();
  const std::vector<Frames> frames = measure_table_2(options, scenes);
  const Table levels = measure_table_3(options, std::ranges::find(scenes, "toys", &TestScene::name)->scene);
  constexpr std::array direct{Drawn{"thesis", &Frames::thesis_direct}, Drawn{"ours", &Frames::our_direct}};
  constexpr std::array table{Drawn{"thesis", &Frames::thesis_table}, Drawn{"ours", &Frames::our_table}};
  std::vector<Plot> plots = draw_table_3(levels);
  plots.push_back(draw_frames("thesis_figure_26a", "Figure 26a: the direct methods", frames, direct));
  plots.push_back(draw_frames("thesis_figure_26b", "Figure 26b: the tables", frames, table));
  return {{tabulate(frames), levels},
          plots,
          {"Curve 1: 1-r, Curve 2: -r^3+r^2+r+1, Curve 3: 3-sqrt(4+6r^2). The scenes of 2001 are lost: ours have their counts.",
           "Our direct method answers to 1e-13, that of the thesis to 1e-6.",
           "flat: drawn by an orthographic camera as in 2001; the other errors with the weight w. points: as Table 3 counts them;",
           "for adaptive refinement those mapped. Errors are of triangles with all corners in sight; what isotropic subdivision",
           "cracks and loses is not counted."}};
}

} // namespace domewarp::bench
