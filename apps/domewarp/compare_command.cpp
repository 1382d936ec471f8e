// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/convert/record.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/read.h"
#include "domewarp/render/compare.h"
#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/scene/image.h"
#include "options.h"

namespace domewarp {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string scene, warped, out;
  ReadOptions read;
  std::optional<double> max_displacement;
  std::optional<std::size_t> max_pinholes;
  bool json = false;
};

void write_picture(const fs::path& path, const Pixels& picture) {
  write_file(path, encode_png(picture.width, picture.height, 4, picture.rgba));
}

void write_pictures(const fs::path& folder, const Frame& reference, const Frame& warped, const CompareReport& report, const Record& record) {
  make_folder(folder);
  write_picture(folder / "raytraced.png", colours(reference));
  write_picture(folder / "rasterised.png", colours(warped));
  write_picture(folder / "difference.png", difference_picture(reference, warped));
  write_picture(folder / "displacement.png", displacement_picture(report, record.raster, 2 * record.tolerance_px));
  write_file(folder / "compare.json", to_json(report) + "\n");
}

std::string to_text(const CompareReport& report) {
  std::ostringstream text;
  text << "coverage      " << report.coverage.reference << " px traced, " << report.coverage.warped << " rasterised, "
       << report.coverage.both << " both\n"
       << "pinholes      " << report.pinholes << "\n"
       << "mismatches    " << report.surface_mismatch << " px show another surface\n";
  text.precision(4);
  if (report.displacement_px.measured > 0)
    text << "displacement  max " << report.displacement_px.max << " px, 99.9 % below " << report.displacement_px.p999 << " px, rms "
         << report.displacement_px.rms << " px\n";
  else
    text << "displacement  not measured: the warped file has no _SOURCE_POSITION (convert --source-attributes)\n";
  text << "depth         max " << 100 * report.depth_rel.max << " % off\n" << "colour        mean difference " << report.colour_difference << " of 255";
  if (report.psnr_db) text << ", PSNR " << *report.psnr_db << " dB";
  text << "\n";
  return text.str();
}

bool is_kept(const Arguments& arguments, const CompareReport& report) {
  bool kept = true;
  const auto broken = [&](const std::string& what) {
    std::cerr << "domewarp: " << arguments.warped << ": " << what << "\n";
    kept = false;
  };
  if (arguments.max_displacement && report.displacement_px.measured == 0)
    broken("--max-displacement cannot be judged without _SOURCE_POSITION");
  if (arguments.max_displacement && report.displacement_px.max > *arguments.max_displacement)
    broken("displacement " + std::to_string(report.displacement_px.max) + " px exceeds --max-displacement");
  if (arguments.max_pinholes && report.pinholes > *arguments.max_pinholes)
    broken(std::to_string(report.pinholes) + " pinholes exceed --max-pinholes");
  return kept;
}

int run(const Arguments& arguments) {
  const Scene warped_scene = read_scene(arguments.warped, arguments.read);
  const Record record = parse_record(warped_scene.extras, arguments.warped);
  const Scene scene = read_scene(arguments.scene, arguments.read);
  const Surface surface(record.surface, screen_radius(record.raster));
  const ImageMap map = make_image_map(surface, Method::automatic);
  RayTraceOptions rays;
  rays.near = record.near;
  rays.unlit = record.unlit;
  const Frame reference = ray_trace(scene, record.view, surface, record.raster, rays);
  const Frame warped = rasterise(warped_scene, record.raster, {.unlit = record.unlit});
  const CompareReport report = compare_frames(reference, warped, surface, map, record.raster);
  if (!arguments.out.empty()) write_pictures(arguments.out, reference, warped, report, record);
  std::cout << (arguments.json ? to_json(report) + "\n" : to_text(report));
  if (!arguments.json && !arguments.out.empty()) std::cout << "pictures      " << arguments.out << "\n";
  return is_kept(arguments, report) ? 0 : static_cast<int>(ErrorCode::unkept);
}

} // namespace

void add_compare_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("compare", "Rasterise a warped file, ray-trace its scene with the same view, and say how they differ.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("SCENE", arguments->scene, "The original scene")->required();
  command->add_option("WARPED", arguments->warped, "The file that convert made of it")->required();
  command->add_option("--out", arguments->out, "Folder for both pictures, their difference, the displacement map and compare.json")->type_name("DIR");
  command->add_option_function<std::string>("--max-displacement", [arguments](const std::string& text) {
    arguments->max_displacement = parse_number("--max-displacement", text); }, "Exit with 3 above this many pixels")->type_name("PX");
  command->add_option_function<std::string>("--max-pinholes", [arguments](const std::string& text) {
    arguments->max_pinholes = parse_count("--max-pinholes", text); }, "Exit with 3 above this many uncovered pixels")->type_name("N");
  command->add_flag("--json", arguments->json, "Print the figures as JSON");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
