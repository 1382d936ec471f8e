// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/convert/report.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/core/parallel.h"
#include "domewarp/gltf/read.h"
#include "domewarp/gltf/write.h"
#include "options.h"

namespace domewarp {

namespace {

struct Arguments {
  std::string input, output, report;
  ConvertOptions options;
  ReadOptions read;
  WriteOptions write;
  bool json = false, quiet = false;
  int threads = 0;
};

int run(const Arguments& arguments) {
  require_surface(arguments.options.surface);
  const ThreadLimit threads(arguments.threads);
  const Scene scene = read_scene(arguments.input, arguments.read);
  ConvertReport report;
  const Scene warped = convert(scene, arguments.options, report);
  write_scene(warped, arguments.output, arguments.write);
  const std::string json = to_json(report, arguments.options);
  if (!arguments.report.empty()) write_file(arguments.report, json);
  if (!arguments.quiet)
    for (const std::string& warning : report.warnings) std::cerr << "domewarp: warning: " << warning << "\n";
  if (arguments.json)
    std::cout << json;
  else if (!arguments.quiet)
    std::cout << arguments.input << " -> " << arguments.output << "\n" << to_text(report, arguments.options);
  if (is_kept(report, arguments.options)) return 0;
  std::cerr << "domewarp: " << arguments.output << ": the tolerance of " << arguments.options.refine.tolerance_px
            << " px was not kept: certified " << report.refine.error_px_max << " px\n";
  return static_cast<int>(ErrorCode::unkept);
}

} // namespace

void add_convert_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("convert", "Turn one scene into pre-warped glTF.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("IN", arguments->input, "The scene (.glb or .gltf)")->required();
  command->add_option("-o,--output", arguments->output, "The warped scene to write (.glb or .gltf)")->required();
  add_view_options(*command, arguments->options.view);
  add_surface_options(*command, arguments->options.surface);
  add_raster_options(*command, arguments->options.raster);
  add_method_option(*command, arguments->options.method);
  add_quality_options(*command, arguments->options.refine);
  add_output_options(*command, arguments->options);
  command->add_flag("--draco", arguments->write.draco, "Compress with KHR_draco_mesh_compression, one grid for the file");
  command->add_flag("--quantize", arguments->write.quantize, "Store integers (KHR_mesh_quantization), one grid for the file");
  add_read_options(*command, arguments->read);
  command->add_option("--report", arguments->report, "Write the report as JSON")->type_name("FILE.json");
  command->add_option("--threads", arguments->threads, "Threads to use (default: all)")->check(CLI::NonNegativeNumber);
  command->add_flag("--json", arguments->json, "Print the report as JSON");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
