// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <memory>
#include <new>
#include <optional>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/convert/job.h"
#include "domewarp/convert/memory_estimate.h"
#include "domewarp/convert/report.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/core/memory.h"
#include "domewarp/core/parallel.h"
#include "frames.h"
#include "job_arguments.h"
#include "options.h"
#include "progress_bar.h"

namespace domewarp {

namespace {

constexpr double default_fps = 30;

struct Arguments {
  std::string input, output;
  std::optional<std::string> report;
  JobOptions job;
  std::optional<FrameRange> frames;
  std::optional<double> fps; ///< default_fps
  bool json = false, quiet = false;
  int threads = 0;
  std::uint64_t max_memory = 0; ///< bytes, 0: no limit
};

void print(const Arguments& arguments, const std::string& output, const ConvertReport& report) {
  if (arguments.quiet) return;
  for (const std::string& warning : report.warnings) std::cerr << "domewarp: warning: " << warning << "\n";
  if (!arguments.json) std::cout << arguments.input << " -> " << output << "\n" << to_text(report, arguments.job.convert);
}

/// One file. @return whether the promise was kept
bool convert_one(const Arguments& arguments, const JobOptions& job, const std::string& output, DisplayCache& displays,
                 std::string& json) {
  ProgressBar bar(arguments.quiet);
  const ConvertReport report = run_job(arguments.input, output, job, &displays, bar.watch());
  bar.clear();
  json = to_json(report, job.convert);
  print(arguments, output, report);
  if (is_kept(report, job.convert)) return true;
  std::cerr << "domewarp: " << output << ": " << broken_promise(report, job.convert) << "\n";
  return false;
}

/// Every frame, in order. The reports become a list.
bool convert_frames(const Arguments& arguments, DisplayCache& displays, std::string& json) {
  JobOptions job = arguments.job;
  if (job.read.animation.empty()) throw Error(ErrorCode::usage, "--frames: needs --animation");
  if (job.read.time != 0) throw Error(ErrorCode::usage, "--time: --frames sets the time of each frame");
  hold_view(arguments.input, job);
  bool kept = true;
  for (std::size_t frame = arguments.frames->first; frame <= arguments.frames->last; ++frame) {
    job.read.time = static_cast<double>(frame) / arguments.fps.value_or(default_fps);
    std::string report;
    kept = convert_one(arguments, job, frame_path(arguments.output, frame), displays, report) && kept;
    json += (json.empty() ? "[\n" : ",\n") + report;
  }
  json += "]\n";
  return kept;
}

bool convert_all(const Arguments& arguments, std::string& json) {
  DisplayCache displays;
  if (arguments.frames) return convert_frames(arguments, displays, json);
  return convert_one(arguments, arguments.job, arguments.output, displays, json);
}

/// The same with no more memory than allowed. @throws Error(unkept) where that is not enough
bool convert_within(Arguments arguments, std::string& json) {
  const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::unkept, arguments.input + ": " + why); };
  limit_memory(arguments.max_memory);
  const FileSurvey survey = survey_file(arguments.input, arguments.job.read.allow_external);
  const std::string why = memory_refusal(estimate_memory(survey, arguments.job.convert), arguments.max_memory);
  if (!why.empty()) refuse(why);
  std::size_t& most = arguments.job.read.max_bytes;
  most = std::min<std::size_t>(most, arguments.max_memory);
  try {
    return convert_all(arguments, json);
  } catch (const std::bad_alloc&) {
    refuse(memory_exhausted(arguments.max_memory));
  }
  return false;
}

int run(const Arguments& arguments) {
  require_surface(arguments.job.convert.surface);
  if (arguments.fps && !arguments.frames) throw Error(ErrorCode::usage, "--fps: needs --frames");
  if (arguments.report && (is_same_file(*arguments.report, arguments.input) || std::filesystem::path(*arguments.report).lexically_normal() == std::filesystem::path(arguments.output).lexically_normal()))
    throw Error(ErrorCode::usage, "--report " + *arguments.report + ": is the name of a scene; the report needs another");
  const ThreadLimit threads(arguments.threads);
  std::string json;
  const bool kept = arguments.max_memory > 0 ? convert_within(arguments, json) : convert_all(arguments, json);
  if (arguments.report) write_file(*arguments.report, json);
  if (arguments.json) std::cout << json;
  return kept ? 0 : static_cast<int>(ErrorCode::unkept);
}

} // namespace

void add_convert_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("convert", "Turn one scene into pre-warped glTF.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("IN", arguments->input, "The scene (.glb or .gltf)")->required();
  command->add_option("-o,--output", arguments->output, "The warped scene to write (.glb or .gltf)")->required();
  add_job_options(*command, arguments->job);
  command->add_option_function<std::string>("--frames", [arguments](const std::string& text) {
           parse_frames("--frames", text, arguments->frames.emplace());
         }, "Write frames FIRST to LAST of the animation, as OUT.0000.glb and so on")->type_name("FIRST:LAST");
  command->add_option_function<std::string>("--fps", [arguments](const std::string& text) {
           arguments->fps = parse_positive("--fps", text);
         }, "Frames per second of --frames (default 30)")->type_name("N");
  command->add_option("--report", arguments->report, "Write the report as JSON")->type_name("FILE.json");
  command->add_option_function<std::string>("--max-memory", [arguments](const std::string& text) {
           arguments->max_memory = parse_memory("--max-memory", text);
         }, "Refuse a scene that needs more memory, exit status 3")->type_name("MIB");
  add_threads_option(*command, arguments->threads);
  command->add_flag("--json", arguments->json, "Print the report as JSON");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->callback([arguments, command, &status] {
    require_use(given_arguments(*command));
    status = run(*arguments);
  });
}

} // namespace domewarp
