// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/memory.h"
#include "suggest.h"

namespace {

/// Whether some command has a value option of this name.
bool takes_value(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    const CLI::Option* option = command->get_option_no_throw(name);
    if (option != nullptr && option->get_items_expected_max() > 0) return true;
    if (takes_value(*command, name)) return true; // option groups
  }
  return false;
}

/// Joins "--curve" "-r+1" to "--curve=-r+1": CLI11 would take the value for an option.
std::vector<std::string> join_values(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> joined;
  for (int i = 1; i < argc; ++i) {
    std::string argument = argv[i];
    const bool value_follows = i + 1 < argc && argv[i + 1][0] == '-' && argv[i + 1][1] != '\0' && argv[i + 1][1] != '-';
    if (argument.starts_with("--") && value_follows && takes_value(app, argument)) argument += '=' + std::string(argv[++i]);
    joined.insert(joined.begin(), std::move(argument)); // CLI11 wants them reversed
  }
  return joined;
}

} // namespace

int main(int argc, char** argv) {
  domewarp::keep_free_memory();
  CLI::App app{"Pre-warped geometry for domes, fisheyes and panoramas: glTF in, glTF out.", "domewarp"};
  app.set_version_flag("--version", std::string("domewarp ") + DOMEWARP_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.footer("Exit status: 0 done, 1 usage, 2 input unreadable or invalid, 3 a promise not kept, 4 output not written.");
  int status = 0;
  domewarp::add_convert_command(app, status);
  domewarp::add_batch_command(app, status);
  domewarp::add_inspect_command(app, status);
  domewarp::add_render_command(app, status);
  domewarp::add_compare_command(app, status);
  domewarp::add_simulate_command(app, status);
  domewarp::add_curve_command(app, status);
  domewarp::add_project_command(app, status);
  domewarp::add_scenes_command(app, status);
  domewarp::add_figures_command(app, status);
  if (const std::string wrong = argc > 1 ? domewarp::unknown_command(app, argv[1]) : ""; !wrong.empty()) {
    std::cerr << "domewarp: " << wrong << "\n";
    return static_cast<int>(domewarp::ErrorCode::usage);
  }
  try {
    app.parse(join_values(app, argc, argv));
  } catch (const CLI::Success& success) { // --help, --version
    status = app.exit(success);
  } catch (const CLI::ExtrasError&) {
    std::cerr << "domewarp: " << domewarp::left_over(app) << "\n";
    return static_cast<int>(domewarp::ErrorCode::usage);
  } catch (const CLI::ParseError& error) {
    std::cerr << "domewarp: " << error.what() << "\n";
    return static_cast<int>(domewarp::ErrorCode::usage);
  } catch (const domewarp::Error& error) {
    std::cerr << "domewarp: " << error.what() << "\n";
    return static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    std::cerr << "domewarp: not enough memory\n";
    return static_cast<int>(domewarp::ErrorCode::unkept);
  } catch (const std::system_error& error) { // no thread to be had, for instance
    std::cerr << "domewarp: the system refuses: " << error.what() << "\n";
    return static_cast<int>(domewarp::ErrorCode::unkept);
  }
  if (std::cout.flush()) return status;
  std::cerr << "domewarp: standard output: cannot be written\n";
  return static_cast<int>(domewarp::ErrorCode::output);
}
