// SPDX-License-Identifier: Apache-2.0
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/convert/batch.h"
#include "domewarp/convert/batch_summary.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/core/memory.h"
#include "job_arguments.h"
#include "options.h"
#include "progress_bar.h"

namespace domewarp {

namespace {

struct Arguments {
  std::vector<std::string> inputs;
  std::string format = "glb";
  BatchOptions batch;
  Shard shard;
  JobOptions job; ///< takes the options of the command line while it is parsed; each scene gets its own later
  bool json = false, quiet = false;
};

Shard parse_shard(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) throw Error(ErrorCode::usage, "--shard: needs K/N, for example 1/4, got '" + text + "'");
  const Shard shard{parse_count("--shard", text.substr(0, slash)), parse_count("--shard", text.substr(slash + 1))};
  if (shard.index < 1 || shard.index > shard.count) throw Error(ErrorCode::usage, "--shard: K must be from 1 to N, got '" + text + "'");
  return shard;
}

int parse_jobs(const std::string& text) {
  const std::size_t jobs = parse_count("--jobs", text);
  if (jobs < 1 || jobs > 1024) throw Error(ErrorCode::usage, "--jobs: must be from 1 to 1024, got " + text);
  return static_cast<int>(jobs);
}

std::string to_line(const BatchRow& row) {
  std::ostringstream line;
  line << (row.up_to_date ? "up to date  " : "converted   ") << row.output.string() << "  " << row.triangles_in << " -> " << row.triangles_out
       << " triangles, " << std::setprecision(2) << row.error_px << " px";
  if (!row.up_to_date) line << std::fixed << ", " << row.seconds << " s";
  if (!row.warnings.empty()) line << "; warning: " << row.warnings.front();
  if (row.warnings.size() > 1) line << " (and " << row.warnings.size() - 1 << " more)";
  return line.str();
}

void print_row(const Arguments& arguments, const BatchRow& row) {
  if (row.status != BatchStatus::converted)
    std::cerr << "domewarp: " << row.message << std::endl;
  else if (!arguments.quiet && !arguments.json)
    std::cout << to_line(row) << std::endl;
}

std::string progress_note(const BatchProgress& progress, double seconds) {
  std::ostringstream note;
  note << progress.done << " of " << progress.total << ", " << std::fixed << std::setprecision(1)
       << static_cast<double>(progress.done) / std::max(seconds, 1e-3) << "/s, " << to_clock(seconds);
  if (progress.share > 0) note << ", " << to_clock(seconds * (1 - progress.share) / progress.share) << " left";
  return note.str();
}

int run(const Arguments& arguments, const std::vector<JobArgument>& given) {
  if (arguments.batch.max_memory > 0) limit_memory(arguments.batch.max_memory);
  const PlanOptions plan{arguments.batch.out, "." + arguments.format, given, parse_arguments};
  const std::vector<BatchItem> items = shard(plan_batch(arguments.inputs, plan), arguments.shard.index, arguments.shard.count);
  ProgressBar bar(arguments.quiet);
  const BatchReport report = run_batch(items, arguments.batch, [&](const BatchRow& row, const BatchProgress& progress) {
    bar.clear();
    print_row(arguments, row);
    bar.show("batch", progress.share, progress_note(progress, bar.seconds()));
  });
  bar.clear();
  const std::filesystem::path summary = arguments.batch.out / summary_name(arguments.shard);
  const std::string json = to_json(report, arguments.batch.out, arguments.shard);
  write_file(summary, json);
  if (arguments.json)
    std::cout << json;
  else if (!arguments.quiet)
    std::cout << to_text(report) << "\n" << summary.string() << "\n";
  return exit_code(report);
}

} // namespace

void add_batch_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("batch", "Convert many scenes: files, folders, or a JSON manifest with options per scene.");
  auto arguments = std::make_shared<Arguments>();
  const auto add_text = [&](const char* name, const char* help, const char* type, const std::function<void(const std::string&)>& take) {
    return command->add_option_function<std::string>(name, take, help)->type_name(type);
  };
  command->add_option("IN", arguments->inputs, "Scenes, folders of scenes, manifests (.json)")->required();
  command->add_option("--out", arguments->batch.out, "Folder to write to; a folder's structure is kept")->required()->type_name("DIR");
  command->add_option("--format", arguments->format, "What is written (default glb)")->check(CLI::IsMember({"glb", "gltf"}))->type_name("glb|gltf");
  add_text("--jobs", "Scenes at once (default: one per processor)", "N", [arguments](const std::string& text) { arguments->batch.jobs = parse_jobs(text); });
  add_text("--shard", "Convert part K of N, for several machines", "K/N", [arguments](const std::string& text) { arguments->shard = parse_shard(text); });
  add_text("--max-memory", "Memory for all jobs together; a scene that needs more is refused", "MIB",
           [arguments](const std::string& text) { arguments->batch.max_memory = parse_memory("--max-memory", text); });
  command->add_flag("--force", arguments->batch.force, "Convert what is up to date too");
  add_job_options(*command, arguments->job);
  command->add_flag("--json", arguments->json, "Print the summary as JSON");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->callback([arguments, command, &status] { status = run(*arguments, given_arguments(*command)); });
}

} // namespace domewarp
