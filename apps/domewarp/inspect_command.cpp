// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/audit/inspect.h"
#include "domewarp/convert/record.h"
#include "domewarp/core/errors.h"
#include "domewarp/gltf/read.h"
#include "options.h"

namespace domewarp {

namespace {

struct Arguments {
  std::string file, source;
  ReadOptions read;
  std::optional<double> hausdorff;
  bool json = false, strict = false;
};

Picture make_picture(const Record& record) {
  Surface surface(record.surface, screen_radius(record.raster));
  ImageMap map = make_image_map(surface, Method::direct);
  return {std::move(surface), std::move(map), record.view, record.raster, record.projection == Projection::perspective, record.near, record.tolerance_px};
}

int run(const Arguments& arguments) {
  const Scene scene = read_scene(arguments.file, arguments.read);
  std::optional<Picture> picture;
  if (!scene.extras.empty()) picture = make_picture(parse_record(scene.extras, arguments.file));
  std::optional<Scene> source;
  if (!arguments.source.empty()) {
    if (!picture) throw Error(ErrorCode::input, arguments.file + ": was not written by domewarp convert, so --source cannot be compared with it");
    source = read_scene(arguments.source, arguments.read);
  }
  if (arguments.hausdorff && !source) throw Error(ErrorCode::usage, "--hausdorff: needs --source");
  InspectOptions options{picture ? &*picture : nullptr, source ? &*source : nullptr};
  options.hausdorff_px = arguments.hausdorff;
  const InspectReport report = inspect(scene, options);
  for (const std::string& warning : scene.warnings) std::cerr << "domewarp: warning: " << warning << "\n";
  std::cout << (arguments.json ? to_json(report) : to_text(report));
  if (!arguments.strict || is_sound(report)) return 0;
  const bool is_exact = !report.cracks || report.cracks->exact_provenance;
  std::cerr << "domewarp: " << arguments.file << ": has cracks, flips or lost area"
            << (is_exact ? "\n" : ", as far as its picture tells; rims and packing can look so: judge what convert --source-attributes writes\n");
  return static_cast<int>(ErrorCode::unkept);
}

} // namespace

void add_inspect_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("inspect", "Mesh and crack statistics of any glTF, raw or warped.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->file, "The scene (.glb or .gltf)")->required();
  command->add_option("--source", arguments->source, "The scene that FILE was converted from: tells its open edges apart, samples lost area and errors")
      ->type_name("SCENE");
  command->add_option_function<std::string>("--hausdorff", [arguments](const std::string& text) { arguments->hausdorff = parse_positive("--hausdorff", text); },
           "Measure how far the exact warp of --source is from FILE, to this error in pixels (slow)")->type_name("PX");
  add_read_options(*command, arguments->read);
  command->add_flag("--strict", arguments->strict, "Exit with 3 when a warped file has cracks, flips or lost area; wants one with _SOURCE_POSITION (convert --source-attributes)");
  command->add_flag("--json", arguments->json, "Print the statistics as JSON");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
