// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/convert/record.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/read.h"
#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/scene/image.h"
#include "options.h"

namespace domewarp {

namespace {

struct Arguments {
  std::string input, output, renderer = "raytrace";
  ConvertOptions options;
  ReadOptions read;
};

/// A raw scene is converted first, a warped one is drawn through the camera in it.
Frame draw(const Scene& scene, const Arguments& arguments) {
  if (!scene.extras.empty()) {
    const Record record = parse_record(scene.extras, arguments.input);
    return rasterise(scene, record.raster, {.unlit = arguments.options.unlit});
  }
  require_surface(arguments.options.surface);
  ConvertOptions options = arguments.options;
  options.refine.source_attributes = true; // lighting needs to know where a vertex came from
  ConvertReport report;
  return rasterise(convert(scene, options, report), options.raster, {.unlit = options.unlit});
}

Frame trace(const Scene& scene, const Arguments& arguments) {
  require_surface(arguments.options.surface);
  if (!scene.extras.empty())
    throw Error(ErrorCode::usage, arguments.input + ": is already warped; --renderer raytrace needs the original scene");
  const View view = resolve_view(scene, arguments.options.view);
  const Surface surface(arguments.options.surface, screen_radius(arguments.options.raster));
  RayTraceOptions rays;
  rays.near = arguments.options.refine.near;
  rays.unlit = arguments.options.unlit;
  return ray_trace(scene, view, surface, arguments.options.raster, rays);
}

int run(const Arguments& arguments) {
  if (arguments.renderer != "raytrace" && arguments.renderer != "gl")
    throw Error(ErrorCode::usage, "--renderer: must be raytrace or gl, got '" + arguments.renderer + "'");
  const Scene scene = read_scene(arguments.input, arguments.read);
  const Frame frame = arguments.renderer == "gl" ? draw(scene, arguments) : trace(scene, arguments);
  write_file(arguments.output, encode_png(frame.width, frame.height, 4, frame.rgba));
  for (const std::string& warning : frame.warnings) std::cerr << "domewarp: warning: " << warning << "\n";
  std::cout << arguments.output << ": " << frame.width << "x" << frame.height << ", " << frame.renderer << "\n";
  return 0;
}

} // namespace

void add_render_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("render", "Draw a scene: by rays from the original, or by OpenGL from warped geometry.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("SCENE", arguments->input, "The scene; a warped one with --renderer gl is drawn as it is")->required();
  command->add_option("-o,--output", arguments->output, "The picture to write (.png)")->required();
  command->add_option("--renderer", arguments->renderer, "raytrace or gl (default raytrace)")->type_name("raytrace|gl");
  add_view_options(*command, arguments->options.view);
  add_surface_options(*command, arguments->options.surface);
  add_raster_options(*command, arguments->options.raster);
  add_method_option(*command, arguments->options.method);
  add_quality_options(*command, arguments->options.refine);
  add_output_options(*command, arguments->options);
  add_read_options(*command, arguments->read);
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
