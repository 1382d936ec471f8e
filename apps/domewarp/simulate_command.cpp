// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/core/parallel.h"
#include "domewarp/gltf/read.h"
#include "domewarp/render/edges.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/render/simulate.h"
#include "options.h"

namespace domewarp {

namespace {

struct Arguments {
  std::string picture, output, scene, direct, difference, outside;
  ReadOptions read;
  ViewOptions view;
  SurfaceOptions surface;
  EyeCamera camera;
  SimulateOptions simulate;
  std::optional<Vec3> look;
  std::optional<double> azimuth, elevation;
  std::optional<double> max_edge_error;
  bool unlit = false, lights = false, json = false;
  int threads = 0;
};

void write_png(const std::string& path, const Pixels& pixels) {
  write_file(path, encode_png(pixels.width, pixels.height, 4, pixels.rgba));
}

Vec3 look_direction(const Arguments& arguments) {
  if (arguments.look && (arguments.azimuth || arguments.elevation))
    throw Error(ErrorCode::usage, "--look: excludes --azimuth and --elevation");
  if (arguments.look) return *arguments.look;
  const double a = arguments.azimuth.value_or(0) * std::numbers::pi / 180, e = arguments.elevation.value_or(0) * std::numbers::pi / 180;
  return {std::sin(a) * std::cos(e), std::sin(e), -std::cos(a) * std::cos(e)};
}

void check(const Arguments& arguments) {
  require_surface(arguments.surface);
  const auto needs_scene = [&](bool given, const char* option) {
    if (given && arguments.scene.empty()) throw Error(ErrorCode::usage, std::string(option) + ": needs --scene");
  };
  needs_scene(!arguments.direct.empty(), "--direct");
  needs_scene(!arguments.difference.empty(), "--difference");
  needs_scene(arguments.max_edge_error.has_value(), "--max-edge-error");
  for (const std::string* path : {&arguments.output, &arguments.direct, &arguments.difference, &arguments.outside})
    if (!path->empty() && !path->ends_with(".png")) throw Error(ErrorCode::usage, *path + ": must end in .png");
}

/// What the camera sees of the scene itself.
Pixels direct_view(const Arguments& arguments) {
  const Scene scene = read_scene(arguments.scene, arguments.read);
  if (!scene.extras.empty())
    throw Error(ErrorCode::usage, arguments.scene + ": is already warped; --scene needs the original");
  RayTraceOptions options;
  options.unlit = arguments.unlit;
  options.lights = arguments.lights;
  options.samples = arguments.simulate.samples;
  options.layers = Layers::colours;
  const View view = turn_view(resolve_view(scene, arguments.view), arguments.camera);
  return colours(ray_trace(scene, view, flat_surface(arguments.camera), arguments.camera.raster, options));
}

/// |a - b| of every channel, four times enlarged.
Pixels difference_of(const Pixels& a, const Pixels& b) {
  Pixels result{a.width, a.height, std::vector<std::uint8_t>(a.rgba.size(), 255)};
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    if (i % 4 != 3) result.rgba[i] = static_cast<std::uint8_t>(std::min(4 * std::abs(int(a.rgba[i]) - int(b.rgba[i])), 255));
  return result;
}

void print(const Arguments& arguments, const std::optional<EdgeReport>& edges) {
  if (arguments.json) {
    nlohmann::ordered_json json;
    json["edges"] = nullptr;
    if (edges)
      json["edges"] = {{"count", edges->count}, {"median", edges->median}, {"p99", edges->p99}, {"within_pixel", edges->within_pixel},
                       {"bias", {edges->bias.x, edges->bias.y}}, {"median_view_px", edges->median_view_px}};
    std::cout << json.dump(2) << "\n";
    return;
  }
  std::cout << arguments.output << ": " << arguments.camera.raster.width << "x" << arguments.camera.raster.height << "\n";
  if (edges)
    std::cout << "edges         " << edges->count << " places, median " << edges->median << ", 99 % below " << edges->p99
              << " pixels of the picture from where the scene has them; shift " << edges->bias.x << ", " << edges->bias.y << "\n";
}

int run(const Arguments& given) {
  Arguments arguments = given;
  arguments.camera.look = look_direction(arguments);
  check(arguments);
  const ThreadLimit threads(arguments.threads);
  const Pixels picture = decode_image(read_file(arguments.picture), arguments.picture);
  const Raster raster{picture.width, picture.height};
  const Surface surface(arguments.surface, screen_radius(raster));
  const Pixels seen = simulate(picture, surface, arguments.camera, arguments.simulate);
  std::optional<EdgeReport> edges;
  Pixels direct;
  if (!arguments.scene.empty()) {
    direct = direct_view(arguments);
    const DisplayedPicture displayed(surface, raster);
    edges = compare_edges(seen, direct, [&](const Vec2& p) { return displayed.pixel_inside(direction_through(arguments.camera, p.x, p.y)); });
  }
  write_png(arguments.output, seen);
  if (!arguments.direct.empty()) write_png(arguments.direct, direct);
  if (!arguments.difference.empty()) write_png(arguments.difference, difference_of(seen, direct));
  if (!arguments.outside.empty()) write_png(arguments.outside, outside_view(picture, surface, arguments.camera, arguments.camera.raster));
  print(arguments, edges);
  if (!arguments.max_edge_error || (edges->count > 0 && edges->median <= *arguments.max_edge_error)) return 0;
  std::cerr << "domewarp: " << arguments.picture << ": "
            << (edges->count ? "median distance of edges " + std::to_string(edges->median) + " px exceeds --max-edge-error"
                             : "--max-edge-error cannot be judged, the view has no clear edge") << "\n";
  return static_cast<int>(ErrorCode::unkept);
}

void add_camera_options(CLI::App& command, Arguments& arguments) {
  auto* group = command.add_option_group("Camera at the eye");
  const auto number = [&](const char* name, const std::string& help, const char* type, auto& out) {
    group->add_option_function<std::string>(name, [name, &out](const std::string& text) { out = parse_number(name, text); }, help)->type_name(type);
  };
  group->add_option_function<std::string>("--look", [&arguments](const std::string& text) { arguments.look = parse_vector("--look", text); },
    "Direction in eye space: x right, y up, the display's axis along -z (default 0,0,-1)")->type_name("X,Y,Z");
  number("--azimuth", "Degrees to the right of the display's axis instead", "DEG", arguments.azimuth);
  number("--elevation", "Degrees above it", "DEG", arguments.elevation);
  number("--view-fov", "Vertical field of view (default 60)", "DEG", arguments.camera.fov_deg);
  add_raster_options(*group, arguments.camera.raster);
}

} // namespace

void add_simulate_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("simulate", "Throw a picture onto the virtual display and look at it: what the viewer will see.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("PICTURE", arguments->picture, "A picture for the display: PNG, JPEG or WebP from render or any other program")->required();
  command->add_option("-o,--output", arguments->output, "The view to write, .png")->required();
  add_camera_options(*command, *arguments);
  add_surface_options(*command, arguments->surface);
  command->add_option_function<std::string>("--samples", [arguments](const std::string& text) {
    arguments->simulate.samples = static_cast<int>(std::min<std::size_t>(parse_count("--samples", text), 1 << 20)); },
    "Samples per pixel of the view (default 16)")->type_name("N");
  command->add_flag_callback("--nearest", [arguments] { arguments->simulate.filter = PictureFilter::nearest; }, "Show the picture's pixels as squares");
  command->add_option("--outside", arguments->outside, "Write the display with the picture on it, seen from outside")->type_name("FILE.png");
  command->add_option("--scene", arguments->scene, "The scene of the picture: measure how far its edges are from where the eye should see them")->type_name("SCENE");
  command->add_option("--direct", arguments->direct, "Write the same view of that scene without a display")->type_name("FILE.png");
  command->add_option("--difference", arguments->difference, "Write the difference of the two views, four times enlarged")->type_name("FILE.png");
  command->add_option_function<std::string>("--max-edge-error", [arguments](const std::string& text) {
    arguments->max_edge_error = parse_number("--max-edge-error", text); }, "Exit with 3 when the median distance of edges exceeds this many pixels of the picture")->type_name("PX");
  add_view_options(*command, arguments->view);
  add_pose_options(*command, arguments->read);
  command->add_flag("--unlit", arguments->unlit, "The picture was made with --unlit");
  command->add_flag("--lights", arguments->lights, "The picture was made with --lights");
  command->add_flag("--json", arguments->json, "Print the figures as JSON");
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
