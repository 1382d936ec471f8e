// SPDX-License-Identifier: Apache-2.0
#include "job_arguments.h"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/scene/view.h"
#include "options.h"

namespace domewarp {

namespace {

const CLI::Option* find_option(const CLI::App& app, const std::string& name) {
  for (const CLI::Option* option : all_options(app))
    if (option->check_lname(name)) return option;
  return nullptr;
}

bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

/// What CLI11 or we say of "--name", without the name.
std::string without_name(const std::string& message, const std::string& name) {
  const std::string prefix = "--" + name + ": ";
  return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
}

void parse_argument(const JobArgument& argument, JobOptions& job) {
  const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::usage, argument.where + ": " + why); };
  CLI::App app;
  app.set_help_flag();
  add_job_options(app, job);
  const CLI::Option* option = find_option(app, argument.name);
  if (option == nullptr) refuse("there is no such option");
  if (is_flag(*option) && argument.value) refuse("must be true or false, got '" + *argument.value + "'");
  if (!is_flag(*option) && !argument.value) refuse("needs a value, got true");
  if (argument.value && argument.value->empty()) refuse("is empty");
  try {
    std::vector<std::string> line{"--" + argument.name + (argument.value ? "=" + *argument.value : "")};
    app.parse(line);
  } catch (const CLI::Error& error) {
    refuse(without_name(error.what(), argument.name));
  } catch (const Error& error) {
    refuse(without_name(error.what(), argument.name));
  }
}

/// A surface that shows nothing is found here and not in each of a thousand scenes.
void check_surface(const std::vector<JobArgument>& arguments, const JobOptions& job) {
  require_surface(job.convert.surface);
  try {
    Surface(job.convert.surface, screen_radius(job.convert.raster));
  } catch (const Error& error) {
    for (const JobArgument& argument : arguments)
      if (argument.name == "curve" || argument.name == "lens" || argument.name == "profile")
        throw Error(ErrorCode::usage, argument.where + ": " + without_name(error.what(), argument.name));
    throw;
  }
}

const JobArgument* find_given(const std::vector<JobArgument>& given, const std::string& name) {
  const auto found = std::find_if(given.begin(), given.end(), [&](const JobArgument& argument) { return argument.name == name; });
  return found == given.end() ? nullptr : &*found;
}

/// `name` works with option `of` only, where `value` is not null with that value of it.
struct Need {
  const char *name, *of, *value;
};
constexpr Need needs[] = {{"fov", "lens", nullptr},          {"profile-unit", "profile", nullptr},
                          {"threshold", "subdivide", "isotropic"}, {"max-lod", "subdivide", "isotropic"},
                          {"light-tolerance", "shading", "bake"},  {"exposure", "shading", "bake"}};

} // namespace

void require_use(const std::vector<JobArgument>& given) {
  for (const Need& need : needs) {
    if (find_given(given, need.name) == nullptr) continue;
    const JobArgument* of = find_given(given, need.of);
    if (of == nullptr || (need.value != nullptr && of->value != need.value))
      throw Error(ErrorCode::usage, std::string("--") + need.name + ": needs --" + need.of + (need.value != nullptr ? std::string(" ") + need.value : ""));
  }
  const auto clash = [&](const char* name, const char* of, const char* value) {
    const JobArgument* other = find_given(given, of);
    if (find_given(given, name) != nullptr && other != nullptr && other->value != value)
      throw Error(ErrorCode::usage, std::string("--") + name + ": contradicts --" + of + " " + other->value.value_or(""));
  };
  clash("unlit", "shading", "unlit");
  clash("extension", "boundary", "tangent");
}

JobOptions parse_arguments(const std::vector<JobArgument>& arguments) {
  JobOptions job;
  for (const JobArgument& argument : arguments) parse_argument(argument, job);
  check_surface(arguments, job);
  return job;
}

std::vector<JobArgument> given_arguments(const CLI::App& command) {
  CLI::App reference;
  JobOptions job;
  add_job_options(reference, job);
  std::vector<JobArgument> given;
  for (const CLI::Option* option : all_options(command)) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const std::string name = option->get_lnames().front();
    if (name == "help" || find_option(reference, name) == nullptr) continue;
    if (is_flag(*option)) {
      given.push_back({name, std::nullopt, "--" + name});
      continue;
    }
    for (const std::string& value : option->results()) given.push_back({name, value, "--" + name});
  }
  return given;
}

} // namespace domewarp
