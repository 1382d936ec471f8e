// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/audit/inspect.h"
#include "domewarp/convert/record.h"
#include "domewarp/gltf/read.h"
#include "options.h"

namespace domewarp {

namespace {

struct Arguments {
  std::string file;
  ReadOptions read;
  bool json = false;
};

int run(const Arguments& arguments) {
  const Scene scene = read_scene(arguments.file, arguments.read);
  const Raster raster = scene.extras.empty() ? Raster{} : parse_record(scene.extras, arguments.file).raster;
  const InspectReport report = inspect(scene, raster.height);
  for (const std::string& warning : scene.warnings) std::cerr << "domewarp: warning: " << warning << "\n";
  std::cout << (arguments.json ? to_json(report) : to_text(report));
  return 0;
}

} // namespace

void add_inspect_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("inspect", "Mesh and crack statistics of any glTF, raw or warped.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->file, "The scene (.glb or .gltf)")->required();
  add_read_options(*command, arguments->read);
  command->add_flag("--json", arguments->json, "Print the statistics as JSON");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
