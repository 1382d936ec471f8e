// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "options.h"

namespace domewarp {

namespace {

struct Arguments {
  SurfaceOptions surface;
  Raster raster;
  Method method = Method::automatic;
  bool inverse = false;
  std::string report;
};

using Json = nlohmann::ordered_json;

/// Maps points as they come: how many there will be is not known, so `auto` is the direct method until as many have come as
/// a table pays for, and tables from then on.
class Projector {
public:
  Projector(const Surface& surface, Method method) : surface_(surface), method_(method), map_(make_image_map(surface, method, 0)) {}

  ImagePoint project(const Vec3& p) {
    if (method_ == Method::automatic && count_ + 1 == table_pays_from) map_ = make_image_map(surface_, Method::table);
    ++count_;
    (has_table() ? by_table_ : by_direct_) += 1;
    const ImagePoint point = domewarp::project(surface_, map_, p);
    ++states_[static_cast<std::size_t>(point.state)];
    return point;
  }

  Json report() const {
    Json json{{"points", count_}};
    for (const PointState state : {PointState::visible, PointState::extended, PointState::blind})
      json[to_string(state)] = states_[static_cast<std::size_t>(state)];
    json["method"] = {{"asked", to_string(method_)}, {"lut", by_table_}, {"direct", by_direct_}};
    for (const BranchMap& branch : map_.branches) {
      const TableReport& table = branch.table();
      json["branches"].push_back({{"method", table.used ? "lut" : "direct"},
                                  {"method_reason", to_string(table.reason)},
                                  {"table", {{"pieces", table.pieces}, {"degree", table.degree}, {"max_error", table.max_error}, {"build_ms", table.build_ms}}}});
    }
    return json;
  }

private:
  bool has_table() const {
    return std::ranges::any_of(map_.branches, [](const BranchMap& branch) { return branch.table().used; });
  }

  const Surface& surface_;
  Method method_;
  ImageMap map_;
  std::size_t count_ = 0, by_table_ = 0, by_direct_ = 0;
  std::array<std::size_t, 3> states_{};
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

void project_line(Projector& projector, const std::string& line, std::size_t number) {
  Vec3 p;
  parse_line(line, number, 3, &p.x);
  const ImagePoint point = projector.project(p);
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
  Projector projector(surface, arguments.method);
  std::ios::sync_with_stdio(false);
  std::cout.precision(17);
  std::string line;
  for (std::size_t number = 1; std::getline(std::cin, line); ++number) {
    if (is_blank(line)) continue;
    arguments.inverse ? unproject_line(surface, line, number) : project_line(projector, line, number);
  }
  std::cout.flush();
  if (!std::cout) throw Error(ErrorCode::output, "standard output: cannot be written");
  if (!arguments.report.empty()) write_file(arguments.report, projector.report().dump(2) + "\n");
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
  command->add_option("--report", arguments->report, "Write as JSON how many points had which state and by which method")
      ->type_name("FILE.json");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
