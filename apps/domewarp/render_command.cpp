// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <iostream>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <glm/matrix.hpp>

#include "commands.h"
#include "domewarp/convert/record.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/gltf/read.h"
#include "domewarp/render/picture_file.h"
#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "options.h"
#include "progress_bar.h"

namespace domewarp {

namespace {

struct Arguments {
  std::string input, output, hot_spot, renderer = "raytrace";
  ConvertOptions options;
  ReadOptions read;
  bool size_given = false, lights = false, shadows = false, quiet = false;
  double exposure = 0, contrast = 0.03;
  int samples = 1, supersample = 1, threads = 0;
};

bool has_surface(const SurfaceOptions& surface) {
  return !surface.curve.empty() || surface.lens.has_value() || !surface.profile.empty();
}

/// Index of the camera that --camera names; the first without it.
std::size_t camera_index(const Scene& scene, const std::string& wanted) {
  if (wanted.empty()) return 0;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    if (scene.cameras[i].name == wanted) return i;
  std::size_t index = 0;
  const auto [end, status] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (status != std::errc() || end != wanted.data() + wanted.size() || index >= scene.cameras.size())
    throw Error(ErrorCode::usage, "--camera: the scene has no camera '" + wanted + "'");
  return index;
}

/// Lights of a scene in the space it is shaded in.
std::optional<std::vector<PlacedLight>> lights_for(const Scene& scene, const Mat4& from_world, const Arguments& arguments) {
  if (!arguments.lights) return std::nullopt;
  if (scene.lights.empty())
    throw Error(ErrorCode::input, arguments.input + ": has no lights (KHR_lights_punctual) to light it with");
  return place_lights(scene, from_world);
}

RasterOptions raster_options(const Arguments& arguments, const Progress& progress) {
  RasterOptions options;
  options.unlit = arguments.options.shading == Shading::unlit;
  options.exposure = arguments.exposure;
  options.layers = layers_for(arguments.output);
  options.supersample = arguments.supersample;
  options.progress = progress;
  return options;
}

/// A warped scene is drawn through the camera in it, and so is a raw one when no surface is named; else it is converted
/// first.
void draw(const Scene& scene, const Arguments& arguments, const Raster& raster, const Progress& progress, const FrameSink& sink) {
  RasterOptions options = raster_options(arguments, progress);
  if (!scene.extras.empty()) {
    if (!scene.cameras.empty()) options.lights = lights_for(scene, glm::inverse(scene.cameras.front().world), arguments);
    return rasterise(scene, raster, options, sink);
  }
  if (!has_surface(arguments.options.surface)) {
    options.camera = camera_index(scene, arguments.options.view.camera);
    if (options.camera < scene.cameras.size())
      options.lights = lights_for(scene, glm::inverse(scene.cameras[options.camera].world), arguments);
    return rasterise(scene, raster, options, sink);
  }
  require_surface(arguments.options.surface);
  ConvertOptions convert_options = arguments.options;
  convert_options.bake.shadows = arguments.shadows;
  convert_options.bake.exposure = arguments.exposure;
  convert_options.refine.source_attributes = true; // lighting needs to know where a vertex came from
  options.lights = lights_for(scene, world_to_eye(resolve_view(scene, convert_options.view)), arguments);
  ConvertReport report;
  rasterise(convert(scene, convert_options, report, progress), raster, options, sink);
}

void trace(const Scene& scene, const Arguments& arguments, const Raster& raster, const Progress& progress, const FrameSink& sink) {
  require_surface(arguments.options.surface);
  if (!scene.extras.empty())
    throw Error(ErrorCode::usage, arguments.input + ": is already warped; --renderer raytrace needs the original scene");
  const View view = resolve_view(scene, arguments.options.view);
  const Surface surface(arguments.options.surface, screen_radius(raster));
  RayTraceOptions rays;
  rays.near = arguments.options.refine.near;
  rays.unlit = arguments.options.shading == Shading::unlit;
  rays.lights = arguments.lights;
  rays.shadows = arguments.shadows;
  rays.exposure = arguments.exposure;
  rays.layers = layers_for(arguments.output);
  rays.samples = arguments.samples;
  rays.contrast = arguments.contrast;
  rays.count_rays = !arguments.hot_spot.empty();
  rays.progress = progress;
  ray_trace(scene, view, surface, raster, rays, sink);
}

void check(const Arguments& arguments) {
  if (arguments.renderer != "raytrace" && arguments.renderer != "gl")
    throw Error(ErrorCode::usage, "--renderer: must be raytrace or gl, got '" + arguments.renderer + "'");
  const bool gl = arguments.renderer == "gl";
  const auto only = [](bool given, const char* option, const char* renderer) {
    if (given) throw Error(ErrorCode::usage, std::string(option) + ": works with --renderer " + renderer + " only");
  };
  only(gl && arguments.samples != 1, "--samples", "raytrace");
  only(gl && !arguments.hot_spot.empty(), "--hot-spot", "raytrace");
  const bool baked = gl && arguments.options.shading == Shading::bake;
  only(gl && arguments.shadows && !baked, "--shadows", "raytrace");
  only(!gl && arguments.supersample != 1, "--supersample", "gl");
  if (arguments.shadows && !arguments.lights && !baked) throw Error(ErrorCode::usage, "--shadows: needs --lights");
}

/// The size that was asked for, else the one a warped file was made for.
Raster raster_for(const Scene& scene, const Arguments& arguments) {
  if (arguments.size_given || scene.extras.empty()) return arguments.options.raster;
  return parse_record(scene.extras, arguments.input).raster;
}

int run(const Arguments& arguments) {
  check(arguments);
  const ThreadLimit threads(arguments.threads);
  const Scene scene = read_scene(arguments.input, arguments.read);
  const Raster raster = raster_for(scene, arguments);
  PictureFile picture(arguments.output, raster.width, raster.height);
  std::optional<PictureFile> hot_spot;
  if (!arguments.hot_spot.empty()) hot_spot.emplace(arguments.hot_spot, raster.width, raster.height);
  std::string renderer;
  std::vector<std::string> warnings;
  const FrameSink store = [&](const Frame& rows, int) {
    picture.write(rows);
    renderer = rows.renderer;
    warnings = rows.warnings;
    if (!hot_spot) return;
    Frame spots;
    spots.width = rows.width;
    spots.height = rows.height;
    spots.rgba = hot_spot_picture(rows, static_cast<std::uint16_t>(arguments.samples + 1)).rgba;
    hot_spot->write(spots);
  };
  ProgressBar bar(arguments.quiet);
  (arguments.renderer == "gl" ? draw : trace)(scene, arguments, raster, bar.watch(), store);
  picture.finish();
  if (hot_spot) hot_spot->finish();
  bar.clear();
  if (arguments.quiet) return 0;
  for (const std::string& warning : warnings) std::cerr << "domewarp: warning: " << warning << "\n";
  std::cout << arguments.output << ": " << raster.width << "x" << raster.height << ", " << renderer << "\n";
  return 0;
}

} // namespace

void add_render_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("render", "Draw a scene: by rays from the original, or by OpenGL from warped geometry.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("SCENE", arguments->input, "The scene; with --renderer gl a warped one, and a raw one without a surface, is drawn through its own camera")->required();
  command->add_option("-o,--output", arguments->output, "The picture to write: .png, or .exr with depth, position, normal, uv and ids")->required();
  command->add_option("--renderer", arguments->renderer, "raytrace or gl (default raytrace)")->type_name("raytrace|gl");
  add_view_options(*command, arguments->options.view);
  add_surface_options(*command, arguments->options.surface);
  add_raster_options(*command, arguments->options.raster);
  add_method_option(*command, arguments->options.method);
  add_quality_options(*command, arguments->options.refine);
  add_output_options(*command, arguments->options);
  add_read_options(*command, arguments->read);
  command->add_option_function<std::string>("--samples", [arguments](const std::string& text) {
    arguments->samples = static_cast<int>(std::min<std::size_t>(parse_count("--samples", text), 1 << 20)); },
    "Rays in pixels with contrast or an outline (default 1)")->type_name("N");
  command->add_option_function<std::string>("--contrast", [arguments](const std::string& text) {
    arguments->contrast = parse_number("--contrast", text); },
    "Difference of lightness to a neighbour that makes a pixel need samples (default 0.03)")->type_name("C");
  command->add_option("--hot-spot", arguments->hot_spot, "Write a picture of where the rays went: the darker, the more")->type_name("FILE.png");
  command->add_option_function<std::string>("--supersample", [arguments](const std::string& text) {
    arguments->supersample = static_cast<int>(std::min<std::size_t>(parse_count("--supersample", text), 1 << 20)); },
    "OpenGL draws N x N samples per pixel (default 1)")->type_name("N");
  command->add_flag("--lights", arguments->lights, "Light with the scene's own lights instead of one at the eye");
  command->add_flag("--shadows", arguments->shadows, "Let opaque surfaces keep those lights away");
  command->add_option_function<std::string>("--exposure", [arguments](const std::string& text) {
    arguments->exposure = parse_number("--exposure", text); }, "Brighten those lights by so many stops (default 0)")->type_name("STOPS");
  add_threads_option(*command, arguments->threads);
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->callback([arguments, command, &status] {
    arguments->size_given = command->count("--size") > 0;
    status = run(*arguments);
  });
}

} // namespace domewarp
