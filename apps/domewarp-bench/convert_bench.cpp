// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <unistd.h>

#include "bench_scenes.h"
#include "benches.h"
#include "child_process.h"
#include "domewarp/convert/job.h"
#include "domewarp/core/errors.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

namespace fs = std::filesystem;

std::size_t decoded_bytes(const Scene& scene) {
  std::size_t bytes = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      bytes += primitive.positions.size() * sizeof(Vec3f) + primitive.indices.size() * sizeof(std::uint32_t);
      for (const Attribute& attribute : primitive.attributes) bytes += attribute.values.size() * sizeof(float);
    }
  return bytes;
}

struct Told {
  double seconds = 0;
  std::size_t triangles = 0, decoded = 0;
};

struct Folder {
  fs::path path = fs::temp_directory_path() / ("domewarp-bench-" + std::to_string(getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

JobOptions job_options() {
  JobOptions options;
  options.convert.surface.lens = Lens::equidistant;
  options.convert.view.eye = Vec3(0);
  options.convert.view.forward = Vec3(0, 0, -1);
  return options;
}

struct Converted {
  double seconds = 0, error_px = 0;
  std::size_t triangles = 0;
};

/// Whole conversions of a bundled scene against the error they are asked for, least time of a few rounds.
void measure_errors(const Options& options, Result& result) {
  Table table{"convert_errors", "toys on 1-r^2 at 4096 rows, from file to file: what a smaller error costs, least of a few rounds",
              {{"tolerance_px", "tolerance px"}, {"error_px", "certified px"}, {"triangles_out", "triangles"}, {"ms", "ms"}, {"ratio", "time / at 4 px"}},
              {}};
  Plot plot{"convert_time_error", "A whole conversion: time against error (toys, 1-r^2)", {"certified error (px of 4096 rows)", true}, {"ms", true}, {{"convert", {}}}};
  const Folder folder;
  const fs::path input = folder.path / "toys.glb", output = folder.path / "out.glb";
  in_child([&] {
    write_scene(bundled("toys"), input);
    return Told{};
  });
  double first = 0;
  for (const double tolerance : options.quick ? std::vector<double>{4, 2} : std::vector<double>{4, 2, 1, 0.5, 0.2, 0.1, 0.05}) {
    options.progress("convert at " + three_digits(tolerance) + " px");
    JobOptions job;
    job.convert.surface.curve = "1-r^2";
    job.convert.raster = {4096, 4096};
    job.convert.refine.tolerance_px = tolerance;
    const Converted best = in_child([&] {
      Converted told;
      told.seconds = std::numeric_limits<double>::infinity();
      for (int round = 0; round < (options.quick ? 1 : 5); ++round) {
        ConvertReport report;
        told.seconds = std::min(told.seconds, seconds([&] { report = run_job(input, output, job); }));
        told.error_px = report.refine.error_px_max;
        told.triangles = report.refine.triangles_out;
      }
      return told;
    });
    if (first == 0) first = best.seconds;
    table.rows.push_back({tolerance, best.error_px, static_cast<double>(best.triangles), 1000 * best.seconds, best.seconds / first});
    plot.series[0].points.emplace_back(best.error_px, 1000 * best.seconds);
  }
  result.tables.push_back(std::move(table));
  result.plots.push_back(std::move(plot));
}

Told convert_only(const fs::path& input, const fs::path& output) {
  Told told;
  told.seconds = seconds([&] { told.triangles = run_job(input, output, job_options()).refine.triangles_out; });
  return told;
}

/// The floor: the same input read, the same output written, nothing in between.
Told read_and_write(const fs::path& input, const fs::path& output, const fs::path& copy) {
  Told told;
  told.seconds = seconds([&] { told.decoded = decoded_bytes(read_scene(input)); });
  const Scene warped = read_scene(output);
  told.decoded += decoded_bytes(warped);
  told.seconds += seconds([&] { write_scene(warped, copy); });
  return told;
}

struct Row {
  Measured<Told> convert, floor;
};

Row measure(std::size_t triangles, int rounds) {
  const Folder folder;
  const fs::path input = folder.path / "in.glb", output = folder.path / "out.glb", copy = folder.path / "copy.glb";
  in_child([&] {
    write_scene(cave(triangles), input);
    return Told{};
  });
  Row row;
  row.convert.seconds = row.floor.seconds = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const Measured<Told> convert = in_child([&] { return convert_only(input, output); });
    const Measured<Told> floor = in_child([&] { return read_and_write(input, output, copy); });
    if (convert.triangles == 0) throw Error(ErrorCode::output, "nothing of the scene was drawn: nothing was measured");
    if (convert.seconds < row.convert.seconds) row.convert = convert;
    if (floor.seconds < row.floor.seconds) row.floor = floor;
  }
  return row;
}

std::vector<Vec2> from_10000(const Series& series) {
  std::vector<Vec2> points = series.points;
  std::erase_if(points, [](const Vec2& p) { return p.x < 10000; });
  return points;
}

} // namespace

Result run_convert_bench(const Options& options) {
  const std::vector<std::size_t> sizes =
      options.quick ? std::vector<std::size_t>{1000} : std::vector<std::size_t>{1000, 10000, 100000, 1000000, 10000000};
  Table table{"convert",
              "convert at 0.5 px of 4096 rows against reading the input and writing the output",
              {{"triangles_in", "in"}, {"triangles_out", "out"}, {"convert_s", "convert s"}, {"read_write_s", "read + write s"},
               {"ratio", "ratio"}, {"peak_mb", "peak MB"}, {"decoded_mb", "decoded MB"}, {"memory_ratio", "peak / decoded"}},
              {}};
  Plot time{"convert_time", "Time of convert", {"triangles in", true}, {"seconds", true}, {{"convert", {}}, {"read + write", {}}}};
  Plot memory{"convert_memory", "Memory of convert", {"triangles in", true}, {"MB", true}, {{"peak", {}}, {"decoded input and output", {}}}};
  for (const std::size_t size : sizes) {
    options.progress("convert: " + std::to_string(size) + " triangles");
    const Row row = measure(size, options.quick ? 1 : size > 1000000 ? 1 : 3);
    const double in = static_cast<double>(size), peak = row.convert.peak_bytes / 1e6, decoded = static_cast<double>(row.floor.decoded) / 1e6;
    table.rows.push_back({in, static_cast<double>(row.convert.triangles), row.convert.seconds, row.floor.seconds,
                          row.convert.seconds / row.floor.seconds, peak, decoded, peak / decoded});
    time.series[0].points.emplace_back(in, row.convert.seconds);
    time.series[1].points.emplace_back(in, row.floor.seconds);
    memory.series[0].points.emplace_back(in, peak);
    memory.series[1].points.emplace_back(in, decoded);
  }
  Result result{{table}, {time, memory}, {}};
  if (!options.quick)
    result.notes.push_back("Slope of the log-log fit from 10^4 triangles on: time " + three_digits(log_log_slope(from_10000(time.series[0]))) + ", peak memory " +
                           three_digits(log_log_slope(from_10000(memory.series[0]))) + ".");
  measure_errors(options, result);
  return result;
}

} // namespace domewarp::bench
