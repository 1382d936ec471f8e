// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/convert/job.h"
#include "domewarp/convert/report.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/core/parallel.h"
#include "options.h"
#include "progress_bar.h"

namespace domewarp {

namespace {

struct Arguments {
  std::string input, output, report;
  JobOptions job;
  bool json = false, quiet = false;
  int threads = 0;
};

void print(const Arguments& arguments, const ConvertReport& report, const std::string& json) {
  if (!arguments.quiet)
    for (const std::string& warning : report.warnings) std::cerr << "domewarp: warning: " << warning << "\n";
  if (arguments.json)
    std::cout << json;
  else if (!arguments.quiet)
    std::cout << arguments.input << " -> " << arguments.output << "\n" << to_text(report, arguments.job.convert);
}

int run(const Arguments& arguments) {
  const ConvertOptions& options = arguments.job.convert;
  require_surface(options.surface);
  const ThreadLimit threads(arguments.threads);
  ProgressBar bar(arguments.quiet);
  const ConvertReport report = run_job(arguments.input, arguments.output, arguments.job, nullptr, bar.watch());
  bar.clear();
  const std::string json = to_json(report, options);
  if (!arguments.report.empty()) write_file(arguments.report, json);
  print(arguments, report, json);
  if (is_kept(report, options)) return 0;
  std::cerr << "domewarp: " << arguments.output << ": " << broken_promise(report, options) << "\n";
  return static_cast<int>(ErrorCode::unkept);
}

} // namespace

void add_convert_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("convert", "Turn one scene into pre-warped glTF.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("IN", arguments->input, "The scene (.glb or .gltf)")->required();
  command->add_option("-o,--output", arguments->output, "The warped scene to write (.glb or .gltf)")->required();
  add_job_options(*command, arguments->job);
  command->add_option("--report", arguments->report, "Write the report as JSON")->type_name("FILE.json");
  command->add_option("--threads", arguments->threads, "Threads to use (default: all)")->check(CLI::NonNegativeNumber);
  command->add_flag("--json", arguments->json, "Print the report as JSON");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
