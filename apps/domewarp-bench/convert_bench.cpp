// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "benches.h"
#include "domewarp/convert/job.h"
#include "domewarp/core/errors.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

namespace fs = std::filesystem;

/// A cave around the eye of about this many triangles, with normals and texture coordinates.
Scene cave(std::size_t triangles) {
  const auto rows = static_cast<std::uint32_t>(std::max(3.0, std::round(std::sqrt(static_cast<double>(triangles) / 4))));
  const std::uint32_t columns = 2 * rows;
  Primitive primitive;
  Attribute normal{"NORMAL", 3, {}}, uv{"TEXCOORD_0", 2, {}};
  for (std::uint32_t i = 0; i <= rows; ++i)
    for (std::uint32_t j = 0; j <= columns; ++j) {
      const double v = static_cast<double>(i) / rows, u = static_cast<double>(j % columns) / columns;
      const double theta = std::numbers::pi * v, phi = 2 * std::numbers::pi * u;
      const Vec3 out(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      const double radius = 5 + 0.5 * std::sin(9 * theta) * std::sin(7 * phi) * std::sin(theta);
      primitive.positions.push_back(Vec3f(out * radius));
      for (int c = 0; c < 3; ++c) normal.values.push_back(static_cast<float>(-out[c]));
      uv.values.insert(uv.values.end(), {static_cast<float>(static_cast<double>(j) / columns), static_cast<float>(v)});
    }
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t a = i * (columns + 1) + j, b = a + 1, c = a + columns + 1, d = c + 1;
      primitive.indices.insert(primitive.indices.end(), {a, c, b, b, c, d});
    }
  primitive.attributes = {std::move(normal), std::move(uv)};
  primitive.material = 0;
  Scene scene;
  scene.meshes.push_back({"cave", {std::move(primitive)}});
  scene.instances.push_back({"cave", 0, Mat4(1)});
  scene.materials.emplace_back();
  return scene;
}

std::size_t decoded_bytes(const Scene& scene) {
  std::size_t bytes = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      bytes += primitive.positions.size() * sizeof(Vec3f) + primitive.indices.size() * sizeof(std::uint32_t);
      for (const Attribute& attribute : primitive.attributes) bytes += attribute.values.size() * sizeof(float);
    }
  return bytes;
}

/// What a child process says through a pipe.
struct Told {
  double seconds = 0;
  std::size_t triangles = 0, decoded = 0;
};

struct Measured : Told {
  double peak_bytes = 0;
};

/// Runs the work in a process of its own, so that its peak of memory is its own too. This process must have no threads.
template <typename Work>
Measured in_child(Work&& work) {
  int ends[2];
  if (pipe(ends) != 0) throw Error(ErrorCode::output, "a pipe cannot be made");
  const pid_t child = fork();
  if (child < 0) throw Error(ErrorCode::output, "a process cannot be started");
  if (child == 0) {
    const Told told = work();
    const bool sent = ::write(ends[1], &told, sizeof told) == static_cast<ssize_t>(sizeof told);
    _exit(sent ? 0 : 1);
  }
  close(ends[1]);
  Measured measured;
  const bool received = ::read(ends[0], static_cast<Told*>(&measured), sizeof(Told)) == static_cast<ssize_t>(sizeof(Told));
  close(ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (!received || status != 0) throw Error(ErrorCode::output, "a measured process failed");
  measured.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  return measured;
}

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
  Measured convert, floor;
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
    const Measured convert = in_child([&] { return convert_only(input, output); });
    const Measured floor = in_child([&] { return read_and_write(input, output, copy); });
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
