// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/core/errors.h"
#include "options.h"

namespace domewarp {

namespace {

struct Arguments {
  SurfaceOptions surface;
  Raster raster;
  Method method = Method::automatic;
  bool inverse = false;
};

/// Reads exactly `count` numbers separated by blanks. @throws Error(input) naming the line.
void parse_line(const std::string& line, std::size_t number, int count, double* out) {
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto skip = [&] {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
  };
  for (int i = 0; i < count; ++i) {
    skip();
    if (at != end && *at == '+') ++at;
    const auto [next, status] = std::from_chars(at, end, out[i]);
    const bool overflow = status == std::errc::result_out_of_range;
    if (status != std::errc() || overflow || (next != end && *next != ' ' && *next != '\t' && *next != '\r'))
      throw Error(ErrorCode::input, "line " + std::to_string(number) + ": needs " + std::to_string(count) + " numbers, got '" + line + "'");
    at = next;
  }
  skip();
  if (at != end)
    throw Error(ErrorCode::input, "line " + std::to_string(number) + ": needs " + std::to_string(count) + " numbers, got '" + line + "'");
}

bool is_blank(const std::string& line) { return line.find_first_not_of(" \t\r") == std::string::npos; }

void project_line(const Surface& surface, const ImageMap& map, const std::string& line, std::size_t number) {
  Vec3 p;
  parse_line(line, number, 3, &p.x);
  const ImagePoint point = project(surface, map, p);
  std::cout << point.x << ' ' << point.y << ' ' << point.depth << ' ' << to_string(point.state) << '\n';
}

void unproject_line(const Surface& surface, const std::string& line, std::size_t number) {
  Vec2 image;
  parse_line(line, number, 2, &image.x);
  Vec3 direction(std::nan(""));
  const bool visible = unproject(surface, image, direction);
  if (!visible) direction = Vec3(std::nan(""));
  std::cout << direction.x << ' ' << direction.y << ' ' << direction.z << ' ' << (visible ? "visible" : "outside") << '\n';
}

int run(const Arguments& arguments) {
  require_surface(arguments.surface);
  const Surface surface(arguments.surface, screen_radius(arguments.raster));
  const ImageMap map = make_image_map(surface, arguments.method);
  std::ios::sync_with_stdio(false);
  std::cout.precision(17);
  std::string line;
  for (std::size_t number = 1; std::getline(std::cin, line); ++number) {
    if (is_blank(line)) continue;
    arguments.inverse ? unproject_line(surface, line, number) : project_line(surface, map, line, number);
  }
  std::cout.flush();
  if (!std::cout) throw Error(ErrorCode::output, "standard output: cannot be written");
  return 0;
}

} // namespace

void add_project_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("project", "Filter: eye-space points 'x y z' to 'x' y' depth state', or back.");
  auto arguments = std::make_shared<Arguments>();
  add_surface_options(*command, arguments->surface);
  add_raster_options(*command, arguments->raster);
  add_method_option(*command, arguments->method);
  command->add_flag("--inverse", arguments->inverse, "Read image points 'x y', write unit rays 'dx dy dz state'");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
