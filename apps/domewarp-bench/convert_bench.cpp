// SPDX-License-Identifier: Apache-2.0
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
  return {{table}, {time, memory}, {}};
}

} // namespace domewarp::bench
