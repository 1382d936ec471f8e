// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/audit/exact_rays.h"
#include "domewarp/convert/record.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/read.h"
#include "domewarp/render/compare.h"
#include "domewarp/render/compare_page.h"
#include "domewarp/render/compare_pictures.h"
#include "domewarp/render/drawn_crossings.h"
#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/scene/image.h"
#include "options.h"

namespace domewarp {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string scene, warped, out, html;
  ReadOptions read;
  std::optional<double> max_displacement;
  std::optional<std::size_t> max_pinholes;
  bool json = false;
};

void write_picture(const fs::path& path, const Pixels& picture) {
  write_file(path, encode_png(picture.width, picture.height, 4, picture.rgba));
}

/// Both pictures and what was found in them.
struct Comparison {
  Record record;
  Frame reference, warped;
  Screen screen; ///< of the warped scene
  CompareReport report;
};

/// Twice the tolerance is red, so what should not be there is.
Pixels displacement_picture(const Comparison& c) {
  return displacement_picture(c.report, c.warped.width, c.warped.height, 2 * c.record.tolerance_px);
}

void write_pictures(const fs::path& folder, const Comparison& c) {
  make_folder(folder);
  write_picture(folder / "raytraced.png", colours(c.reference));
  write_picture(folder / "rasterised.png", colours(c.warped));
  write_picture(folder / "difference.png", difference_picture(c.reference, c.warped));
  write_picture(folder / "displacement.png", displacement_picture(c));
  write_picture(folder / "cracks.png", crack_picture(c.report, c.warped));
  write_picture(folder / "wireframe.png", wireframe_picture(c.warped, c.screen));
  write_file(folder / "compare.json", to_json(c.report) + "\n");
}

/// How far from its place anything may be drawn: the file's tolerance and a step of the rasteriser's grid.
double bound_px(const Record& record, const Frame& warped) {
  return record.tolerance_px + (warped.subpixel_bits >= 0 ? std::exp2(-warped.subpixel_bits) : subpixel_step);
}

void write_page(const std::string& path, const Arguments& arguments, const Comparison& c) {
  ComparePage page;
  page.scene = fs::path(arguments.scene).filename().string();
  page.warped = fs::path(arguments.warped).filename().string();
  page.renderer = c.warped.renderer;
  page.tolerance_px = c.record.tolerance_px;
  page.bound_px = bound_px(c.record, c.warped);
  page.reference = colours(c.reference);
  page.rasterised = colours(c.warped);
  page.difference = difference_picture(c.reference, c.warped);
  page.displacement = displacement_picture(c);
  page.cracks = crack_picture(c.report, c.warped);
  page.wireframe = wireframe_picture(c.warped, c.screen);
  write_file(path, compare_page(page, c.report, Surface(c.record.surface, screen_radius(c.record.raster))));
}

std::string at_seams(std::size_t count) {
  return count == 0 ? "" : " (" + std::to_string(count) + " where the outlines of two pieces meet)";
}

std::string to_text(const CompareReport& report) {
  std::ostringstream text;
  text << "coverage      " << report.coverage.reference << " px traced, " << report.coverage.warped << " rasterised, "
       << report.coverage.both << " both\n"
       << "pinholes      " << report.pinholes << at_seams(report.pinholes_at_seams) << "\n";
  if (report.overlaps) text << "overlaps      " << *report.overlaps << "\n";
  text << "mismatches    " << report.surface_mismatch << " px show a hidden surface" << at_seams(report.surface_mismatch_at_seams)
       << ", " << report.depth_ties << " one of two at the same depth; " << report.outline << " differ at outlines, within the bound\n";
  text.precision(4);
  if (report.displacement_px.measured > 0)
    text << "displacement  max " << report.displacement_px.max << " px, 99.9 % below " << report.displacement_px.p999 << " px, rms "
         << report.displacement_px.rms << " px\n";
  else
    text << "displacement  not measured: the warped file has no _SOURCE_POSITION (convert --source-attributes)\n";
  if (report.depth_rel.measured > 0)
    text << "depth         max " << 100 * report.depth_rel.max << " % off, as the depth buffer saw it\n";
  text << "colour        mean difference " << report.colour_difference << " of 255";
  if (report.psnr_db) text << ", PSNR " << *report.psnr_db << " dB";
  if (report.ssim) text << ", SSIM " << *report.ssim;
  text << ", FLIP mean " << report.flip.mean << " max " << report.flip.max << "\n";
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

CompareOptions compare_options(const Record& record, const Frame& warped) {
  CompareOptions options;
  options.bound_px = bound_px(record, warped);
  options.depth_bound = 2 * record.depth_error + 1e-6; // each of two surfaces may be off by it; the rest is rounding
  return options;
}

/// @throws Error(input) for a file that was made of another scene
void require_origin(const Arguments& arguments, const Scene& scene, const Record& record) {
  const std::size_t triangles = count_triangles(scene);
  if (record.triangles_in == 0 || record.triangles_in == triangles) return;
  throw Error(ErrorCode::input, arguments.warped + ": was made of a scene of " + std::to_string(record.triangles_in) + " triangles, " + arguments.scene + " has " + std::to_string(triangles));
}

Comparison compare(const Arguments& arguments) {
  ReadOptions as_it_is; // the scene and the pose are the original's
  as_it_is.allow_external = arguments.read.allow_external;
  const Scene warped = read_scene(arguments.warped, as_it_is);
  Comparison c;
  c.record = parse_record(warped.extras, arguments.warped);
  const Record& record = c.record;
  const Scene scene = read_scene(arguments.scene, arguments.read);
  require_origin(arguments, scene, record);
  const Surface surface(record.surface, screen_radius(record.raster));
  const ImageMap map = make_image_map(surface, Method::automatic);
  RayTraceOptions rays;
  rays.near = record.near;
  rays.unlit = record.unlit;
  rays.lights = record.baked && !scene.lights.empty();
  rays.shadows = record.shadows;
  rays.exposure = record.exposure;
  c.reference = ray_trace(scene, record.view, surface, record.raster, rays);
  RasterOptions raster;
  raster.unlit = record.unlit;
  c.warped = rasterise(warped, record.raster, raster);
  if (record.surface.extension_deg > 0) clear_beyond(c.warped, surface.r_max()); // no ray sees what lies there
  c.screen = make_screen(warped, record.raster);
  const ExactRays exact(scene, record.view);
  const CrossingsAlong crossings =
      keep_drawn(scene, [&exact](const Vec3& direction) { return exact.crossings(direction); }, record.near);
  c.report = compare_frames(c.reference, c.warped, c.screen, surface, map, record.raster, crossings, compare_options(record, c.warped));
  return c;
}

int run(const Arguments& arguments) {
  const Comparison c = compare(arguments);
  if (!arguments.out.empty()) write_pictures(arguments.out, c);
  if (!arguments.html.empty()) write_page(arguments.html, arguments, c);
  std::cout << (arguments.json ? to_json(c.report) + "\n" : to_text(c.report));
  if (!arguments.json && !arguments.out.empty()) std::cout << "pictures      " << arguments.out << "\n";
  return is_kept(arguments, c.report) ? 0 : static_cast<int>(ErrorCode::unkept);
}

} // namespace

void add_compare_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("compare", "Rasterise a warped file, ray-trace its scene with the same view, and say how they differ.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("SCENE", arguments->scene, "The original scene")->required();
  command->add_option("WARPED", arguments->warped, "The file that convert made of it")->required();
  command->add_option("--out", arguments->out, "Folder for both pictures, their difference, displacement, cracks, wireframe and compare.json")->type_name("DIR");
  command->add_option("--html", arguments->html, "Write one page with all of it that opens in any browser, offline")->type_name("FILE.html");
  command->add_option_function<std::string>("--max-displacement", [arguments](const std::string& text) {
    arguments->max_displacement = parse_number("--max-displacement", text); }, "Exit with 3 above this many pixels")->type_name("PX");
  command->add_option_function<std::string>("--max-pinholes", [arguments](const std::string& text) {
    arguments->max_pinholes = parse_count("--max-pinholes", text); }, "Exit with 3 above this many uncovered pixels")->type_name("N");
  add_read_options(*command, arguments->read);
  command->add_flag("--json", arguments->json, "Print the figures as JSON");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
