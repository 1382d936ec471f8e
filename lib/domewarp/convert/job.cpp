// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/job.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "domewarp/convert/packed_flips.h"
#include "domewarp/convert/packing_error.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/geometric_extensions.h"
#include "domewarp/gltf/survey.h"
#include "domewarp/gltf/vertex_order.h"

namespace domewarp {

namespace {

/// No output over the scene or what it refers to.
void require_apart(const std::filesystem::path& input, const std::filesystem::path& output, bool allow_external) {
  if (is_same_file(input, output)) throw Error(ErrorCode::usage, output.string() + ": is the scene itself; the warped one needs another name");
  std::filesystem::path binary = output;
  if (binary.replace_extension(".bin"); output.extension() != ".gltf" || !std::filesystem::exists(binary)) return;
  for (const std::filesystem::path& side : survey_file(input, allow_external).side_files)
    if (is_same_file(side, binary)) throw Error(ErrorCode::usage, output.string() + ": its " + binary.filename().string() + " is part of the scene; the warped one needs another name");
}

/// Rounding to the file's grid must not turn triangles over; how each must turn is told by where it came from.
bool needs_mending(const JobOptions& options) {
  return (options.write.draco || options.write.quantize) && options.convert.refine.subdivision == Subdivision::adaptive;
}

void mend_packing(Scene& warped, WriteOptions& write, const ConvertOptions& options, ConvertReport& report) {
  const PackedFlips flips = mend_packed_flips(warped, write, options.refine.projection, options.raster);
  report.packing_px = std::max(report.packing_px, flips.moved_px);
  report.packing_turned = flips.left;
  report.packing_mended = flips.found - std::min(flips.found, flips.left);
  if (options.refine.source_attributes) return;
  for (Mesh& mesh : warped.meshes)
    for (Primitive& primitive : mesh.primitives) std::erase_if(primitive.attributes, [](const Attribute& a) { return a.name == "_SOURCE_POSITION"; });
}

} // namespace

ConvertReport run_job(const std::filesystem::path& input, const std::filesystem::path& output, const JobOptions& options,
                      DisplayCache* displays, const Progress& progress) {
  require_apart(input, output, options.read.allow_external);
  tell(progress, "read");
  Scene scene = read_scene(input, options.read);
  if (!scene.extras.empty()) scene.warnings.push_back("is warped already, and is warped once more");
  if (scene.animations > 0 && options.read.animation.empty())
    scene.warnings.push_back("shows the rest pose and not its " + std::to_string(scene.animations) +
                             " animation(s): --animation poses the scene, --frames writes every frame");
  ConvertReport report;
  report.input = input.string();
  report.output = output.string();
  report.animation = options.read.animation;
  report.time = options.read.time;
  ConvertOptions convert_options = options.convert;
  WriteOptions write = options.write;
  if (needs_mending(options)) convert_options.refine.source_attributes = true;
  DisplayCache own;
  const auto start = std::chrono::steady_clock::now();
  const auto display = (displays != nullptr ? *displays : own)
                           .find(options.convert.surface, options.convert.raster, options.convert.method, expected_points(scene, options.convert));
  const double map_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const bool had_lights = !scene.lights.empty();
  Scene warped = convert(std::move(scene), convert_options, *display, report, progress);
  report.map_ms = map_ms;
  report.total_ms += map_ms;
  const bool lights_dropped = had_lights && warped.lights.empty();
  scene = {};
  for (const std::string& name : drop_geometric_extensions(warped)) report.dropped_extensions.push_back(name);
  if (lights_dropped) report.dropped_extensions.push_back("KHR_lights_punctual");
  optimize_vertex_order(warped);
  report.packing_px = packing_error_px(warped, write, options.convert.refine.projection, options.convert.raster);
  if (needs_mending(options)) mend_packing(warped, write, options.convert, report);
  tell(progress, "write");
  write_scene(warped, output, write);
  return report;
}

} // namespace domewarp
