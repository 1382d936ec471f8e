// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/profile/facts.h"
#include "domewarp/profile/plot.h"
#include "options.h"

namespace domewarp {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  SurfaceOptions surface;
  Raster raster;
  Method method = Method::automatic;
  bool json = false;
  std::optional<std::string> plot;
};

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// A number, or null for an infinite one.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json table_json(const TableReport& table) {
  return {{"used", table.used}, {"reason", to_string(table.reason)}, {"pieces", table.pieces}, {"degree", table.degree}, {"max_error", table.max_error}, {"build_ms", table.build_ms}};
}

/// All branches taken together.
TableReport total(const ImageMap& map) {
  TableReport sum{true, TableReason::used};
  for (const BranchMap& branch : map.branches) {
    const TableReport& table = branch.table();
    sum = {sum.used && table.used, table.used ? sum.reason : table.reason, sum.pieces + table.pieces, std::max(sum.degree, table.degree),
           std::max(sum.max_error, table.max_error), sum.build_ms + table.build_ms};
  }
  return sum;
}

Json branches_json(const ImageMap& map) {
  Json branches = Json::array();
  for (const BranchMap& map_of_branch : map.branches) {
    const Branch& branch = map_of_branch.branch();
    branches.push_back({{"r", {branch.radius_low, branch.radius_high}},
                        {"theta_deg", {degrees(branch.theta_low), degrees(branch.theta_high)}},
                        {"orientation", branch.orientation},
                        {"fold", {branch.fold_low, branch.fold_high}},
                        {"table", table_json(map_of_branch.table())}});
  }
  return branches;
}

Json kinks_json(const Surface& surface) {
  Json kinks = Json::array();
  for (const Kink& kink : surface.kinks())
    kinks.push_back({{"r", kink.r}, {"z", kink.z}, {"image_radius", kink.image_radius}, {"theta_deg", degrees(kink.theta)}, {"kind", to_string(kink.kind)}});
  return kinks;
}

Json projector_json(const Surface& surface) {
  if (!surface.options().projector) return {};
  return {{"distance", *surface.options().projector},
          {"lit_to", surface.rim().point.x},
          {"hidden_from", number(surface.hidden_from())},
          {"explanation", explain_projector(surface)}};
}

std::string to_json(const Surface& surface, const ImageMap& map) {
  const Vec2 range = visible_range(surface);
  const BlindCone blind = surface.blind();
  const Domain domain = find_domain(surface);
  const SurfaceRim rim = surface.rim();
  Json json;
  json["surface"] = name_of(surface);
  json["r_max"] = surface.r_max();
  json["r_max_reason"] = to_string(surface.r_max_limit());
  json["r_max_explanation"] = explain_r_max(surface);
  json["screen_radius"] = surface.screen_radius();
  json["fov_deg"] = degrees(field_of_view(surface));
  json["visible_deg"] = {degrees(range.x), degrees(range.y)};
  json["blind_from_deg"] = degrees(blind.theta_low);
  json["blind_to_deg"] = degrees(blind.theta_high);
  json["domain"] = {{"end", domain.end < domain.searched_to ? Json(domain.end) : Json()}, {"searched_to", domain.searched_to}};
  json["rim"] = {{"r", rim.point.x}, {"z", rim.point.y}, {"tangent", {rim.tangent.x, rim.tangent.y}}};
  json["kinks"] = kinks_json(surface);
  json["branches"] = branches_json(map);
  json["projector"] = projector_json(surface);
  json["table"] = table_json(total(map));
  return json.dump(2) + "\n";
}

void print(const Surface& surface, const ImageMap& map) {
  std::cout << name_of(surface) << "\n";
  for (const std::string& line : summarise(surface)) std::cout << line << "\n";
  const TableReport table = total(map);
  if (!table.used) {
    std::cout << "table: not used, the direct method answers: " << to_string(table.reason) << "\n";
    return;
  }
  std::cout << "table: " << table.pieces << " pieces of degree " << table.degree << ", error at most " << table.max_error
            << " image units, built in " << table.build_ms << " ms\n";
}

int run(const Arguments& arguments) {
  require_surface(arguments.surface);
  if (arguments.plot && std::filesystem::path(*arguments.plot).extension() != ".svg")
    throw Error(ErrorCode::usage, "--plot: the name must end in .svg, got '" + *arguments.plot + "'");
  const Surface surface(arguments.surface, screen_radius(arguments.raster));
  const ImageMap map = make_image_map(surface, arguments.method);
  if (arguments.plot) write_file(*arguments.plot, plot_svg(surface));
  if (arguments.json)
    std::cout << to_json(surface, map);
  else
    print(surface, map);
  return 0;
}

} // namespace

void add_curve_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("curve", "Analyse a surface: domain, branches, r_max, field of view, blind spot, table.");
  auto arguments = std::make_shared<Arguments>();
  add_surface_options(*command, arguments->surface);
  add_raster_options(*command, arguments->raster);
  add_method_option(*command, arguments->method);
  command->add_flag("--json", arguments->json, "Print JSON");
  command->add_option("--plot", arguments->plot, "Write a cross-section of the display")->type_name("FILE.svg");
  command->callback([arguments, &status] { status = run(*arguments); });
}

} // namespace domewarp
