// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "benches.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/core/memory.h"
#include "machine.h"

namespace domewarp::bench {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  bool quick = false, json = false;
  std::filesystem::path out;
};

Json to_json(const Table& table) {
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json object;
    for (std::size_t i = 0; i < row.size(); ++i)
      std::visit([&](const auto& value) { object[table.columns[i].key] = value; }, row[i]); // not finite: null
    rows.push_back(std::move(object));
  }
  return rows;
}

void print(const std::string& name, const Result& result, bool json) {
  if (json) {
    Json all{{"bench", name}, {"machine", machine()}};
    for (const Table& table : result.tables) all["tables"][table.name] = to_json(table);
    all["notes"] = result.notes;
    std::cout << all.dump(2) << '\n';
    return;
  }
  std::cout << "Machine: " << machine() << "\n\n";
  for (const Table& table : result.tables) std::cout << to_text(table) << '\n';
  for (const std::string& note : result.notes) std::cout << note << '\n';
}

void write(const Result& result, const std::filesystem::path& folder) {
  std::error_code status;
  std::filesystem::create_directories(folder, status);
  if (status) throw Error(ErrorCode::output, folder.string() + ": cannot be made: " + status.message());
  for (const Table& table : result.tables) write_file(folder / (table.name + ".csv"), to_csv(table));
  for (const Plot& plot : result.plots) write_file(folder / (plot.name + ".svg"), to_svg(plot, machine()));
}

void run(const Bench& bench, const Arguments& arguments) {
  Options options{arguments.quick};
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (terminal) options.progress = [](const std::string& what) { std::cerr << "\r\033[K" << what << std::flush; };
  const Result result = bench.run(options);
  if (terminal) std::cerr << "\r\033[K";
  print(bench.name, result, arguments.json);
  if (!arguments.out.empty()) write(result, arguments.out);
}

void add_command(CLI::App& app, const Bench& bench, Arguments& arguments) {
  auto* command = app.add_subcommand(bench.name, bench.description);
  command->add_flag("--quick", arguments.quick, "Smoke test: all rows, on data too small to mean anything");
  command->add_flag("--json", arguments.json, "Print JSON instead of tables");
  command->add_option("--out", arguments.out, "Write each table as CSV and each plot as SVG to this folder")->type_name("DIR");
  command->callback([&bench, &arguments] { run(bench, arguments); });
}

} // namespace

} // namespace domewarp::bench

int main(int argc, char** argv) {
  domewarp::keep_free_memory(); // as domewarp itself
  CLI::App app{"Measures domewarp: figures are ratios within one run on the machine named beside them.", "domewarp-bench"};
  app.require_subcommand(1);
  domewarp::bench::Arguments arguments;
  for (const domewarp::bench::Bench& bench : domewarp::bench::benches) domewarp::bench::add_command(app, bench, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) { // --help
    return app.exit(success);
  } catch (const CLI::RequiredError&) {
    std::cerr << "domewarp-bench: " << (argc > 1 ? "there is no bench '" + std::string(argv[1]) + "'" : "which bench?") << "; --help lists them\n";
    return static_cast<int>(domewarp::ErrorCode::usage);
  } catch (const CLI::ParseError& error) {
    std::cerr << "domewarp-bench: " << error.what() << "\n";
    return static_cast<int>(domewarp::ErrorCode::usage);
  } catch (const domewarp::Error& error) {
    std::cerr << "domewarp-bench: " << error.what() << "\n";
    return static_cast<int>(error.code());
  }
  return 0;
}
