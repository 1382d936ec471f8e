// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/core/files.h"
#include "domewarp/core/parallel.h"
#include "figures.h"
#include "options.h"
#include "progress_bar.h"

namespace domewarp {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string out;
  Studio studio;
  int threads = 0;
  bool quick = false, quiet = false;
};

void write_png(const fs::path& path, const Pixels& pixels) {
  write_file(path, encode_png(pixels.width, pixels.height, 4, pixels.rgba));
}

/// By number, then by letter.
bool comes_before(const Figure& a, const Figure& b) {
  const auto number = [](const std::string& name) {
    int value = 0;
    std::from_chars(name.data(), name.data() + name.size(), value);
    return value;
  };
  return number(a.name) != number(b.name) ? number(a.name) < number(b.name) : a.name < b.name;
}

int run(const Arguments& given) {
  Studio studio = given.studio;
  if (given.quick) studio.raster = {160, 120}, studio.samples = 8;
  const ThreadLimit threads(given.threads);
  make_folder(given.out);
  studio.scenes = make_test_scenes();
  ProgressBar bar(given.quiet);
  std::vector<Figure> figures = ray_figures(studio, bar.watch());
  for (Figure& figure : point_figures(studio, bar.watch())) figures.push_back(std::move(figure));
  std::stable_sort(figures.begin(), figures.end(), comes_before);
  for (const Figure& figure : figures) {
    std::string name = figure.name;
    std::replace(name.begin(), name.end(), '\'', '2');
    write_png(fs::path(given.out) / ("figure_" + name + ".png"), figure.pixels);
  }
  write_png(fs::path(given.out) / "figures.png", contact_sheet(figures, 9, given.quick ? 80 : 150));
  bar.clear();
  if (!given.quiet) std::cout << given.out << ": " << figures.size() << " pictures, all of them on figures.png\n";
  return 0;
}

} // namespace

void add_figures_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("figures", "Make the pictures of the founding thesis from the bundled scenes, and one sheet with all of them.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("--out", arguments->out, "Folder for the pictures")->type_name("DIR")->required();
  add_raster_options(*command, arguments->studio.raster);
  command->add_option_function<std::string>("--samples", [arguments](const std::string& text) {
    arguments->studio.samples = static_cast<int>(std::min<std::size_t>(parse_count("--samples", text), 1 << 20)); },
    "Rays in pixels with contrast or an outline (default 32)")->type_name("N");
  command->add_flag("--quick", arguments->quick, "Small pictures, to see that all can be made");
  add_threads_option(*command, arguments->threads);
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
