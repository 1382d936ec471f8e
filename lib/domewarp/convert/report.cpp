// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/report.h"

#include <iomanip>
#include <numbers>
#include <sstream>

#include <nlohmann/json.hpp>

#include "domewarp/convert/record.h"

namespace domewarp {

namespace {

using Json = nlohmann::ordered_json;

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

Json branches_json(const ConvertReport& report) {
  Json branches = Json::array();
  for (std::size_t i = 0; i < report.branches.size(); ++i) {
    const Branch& branch = report.branches[i];
    const TableReport& table = report.tables[i];
    branches.push_back({{"r", {branch.radius_low, branch.radius_high}},
                        {"theta_deg", {degrees(branch.theta_low), degrees(branch.theta_high)}},
                        {"orientation", branch.orientation},
                        {"method", table.used ? "lut" : "direct"},
                        {"method_reason", to_string(table.reason)},
                        {"table", {{"pieces", table.pieces}, {"degree", table.degree}, {"max_error", table.max_error}, {"build_ms", table.build_ms}}}});
  }
  return branches;
}

/// What was asked for and what answered; branch by branch under "surface".
Json method_json(const ConvertReport& report, const ConvertOptions& options) {
  std::size_t tables = 0;
  for (const TableReport& table : report.tables) tables += table.used;
  return {{"asked", to_string(options.method)},
          {"used", tables == 0 ? "direct" : tables == report.tables.size() ? "lut" : "lut and direct"},
          {"expected_points", report.expected_points}};
}

/// "lut" or "direct", and why where the choice was ours.
std::string method_text(const ConvertReport& report, const ConvertOptions& options) {
  std::string text = method_json(report, options)["used"];
  for (const TableReport& table : report.tables)
    if (!table.used && table.reason != TableReason::direct_asked) return text + ": " + to_string(table.reason);
  return text;
}

std::size_t culled(const SkipReport& skipped) {
  return skipped.outside_view + skipped.back_faces + skipped.degenerate + skipped.off_picture + skipped.zero_area + skipped.hidden;
}

/// Counts, and under "share" the same over what they are counted among: triangles of the source, those refined, or attributes.
Json skipped_json(const RefineReport& refine) {
  const SkipReport& skipped = refine.skipped;
  const std::size_t refined = refine.triangles_out + skipped.off_picture + skipped.zero_area + skipped.hidden;
  Json json, share;
  const auto add = [&](const char* name, std::size_t count, std::size_t among) {
    json[name] = count;
    share[name] = among > 0 ? static_cast<double>(count) / static_cast<double>(among) : 0.0;
  };
  add("outside_view", skipped.outside_view, refine.triangles_in);
  add("back_faces", skipped.back_faces, refine.triangles_in);
  add("degenerate", skipped.degenerate, refine.triangles_in);
  add("off_picture", skipped.off_picture, refined);
  add("small_faces", skipped.small_faces, refine.triangles_in);
  add("zero_area", skipped.zero_area, refined);
  add("hidden", skipped.hidden, refined);
  add("unused_attributes", skipped.unused_attributes, skipped.attributes);
  json["share"] = share;
  return json;
}

/// Null where nobody counted: the thesis' recursion keeps no edges.
Json cracks_json(const RefineReport& refine, Subdivision subdivision) {
  if (subdivision == Subdivision::isotropic) return nullptr;
  return {{"open_edges", refine.open_edges},
          {"open_edges_in", refine.open_edges_in},
          {"t_junctions_in", refine.t_junctions_in},
          {"t_junctions_out", refine.t_junctions_out},
          {"near_misses", refine.near_misses},
          {"snapped", refine.snapped},
          {"max_gap_px", refine.max_gap_px}};
}

/// Whether it is the depth rather than the displacement that made the triangles as small as they are.
bool depth_decides(const RefineReport& refine, const RefineOptions& options) {
  return refine.depth_error_max > 0.8 * options.depth_tolerance && refine.error_px_max < 0.5 * options.tolerance_px;
}

} // namespace

std::string to_json(const ConvertReport& report, const ConvertOptions& options) {
  const RefineReport& refine = report.refine;
  Json json;
  json["triangles"] = {{"input", refine.triangles_in},
                       {"culled", culled(refine.skipped)},
                       {"clipped", refine.triangles_clipped},
                       {"output", refine.triangles_out}};
  json["lines"] = {{"input", refine.lines_in}, {"output", refine.lines_out}};
  json["points"] = {{"input", refine.points_in}, {"output", refine.points_out}};
  json["vertices"] = refine.vertices;
  json["tolerance_px"] = options.refine.tolerance_px;
  json["error_px"] = {{"max", refine.error_px_max}, {"p99", refine.error_px_p99}, {"mean", refine.error_px_mean}};
  if (std::max(options.refine.texture_tolerance_px, options.refine.plain_tolerance_px) > options.refine.tolerance_px)
    json["slide_px"] = {{"max", refine.slide_px_max}, {"plain_faces", refine.plain_faces}};
  json["packing_px"] = report.packing_px;
  json["packing_flips"] = {{"mended", report.packing_mended}, {"left", report.packing_turned}};
  json["depth_error_rel"] = {{"max", refine.depth_error_max}};
  json["cracks"] = cracks_json(refine, options.refine.subdivision);
  json["skipped"] = skipped_json(refine);
  json["refinement"] = {{"levels", refine.levels},
                        {"map_evaluations", refine.map_evaluations},
                        {"uncertified_edges", refine.uncertified_edges},
                        {"uncertified_faces", refine.uncertified_faces},
                        {"near", refine.near}};
  if (options.refine.subdivision == Subdivision::isotropic)
    json["isotropic"] = {{"threshold", options.refine.isotropic.threshold},
                         {"max_lod", options.refine.isotropic.max_lod},
                         {"points", refine.isotropic.points},
                         {"points_computed", refine.isotropic.points_computed},
                         {"divisions", refine.isotropic.divisions},
                         {"invisible", refine.isotropic.invisible}};
  json["method"] = method_json(report, options);
  if (options.shading == Shading::bake)
    json["baked"] = {{"lights", report.baked.lights},
                     {"vertices", report.baked.vertices},
                     {"clipped_vertices", report.baked.clipped_vertices},
                     {"brightest", report.baked.brightest}};
  json["time_ms"] = {{"map", report.map_ms},
                     {"hidden", report.hidden_ms},
                     {"topology", refine.soup_ms},
                     {"refine", refine.levels_ms},
                     {"emit", refine.emit_ms},
                     {"total", report.total_ms}};
  json["peak_memory_mb"] = report.peak_memory_mb;
  json["surface"] = Json::parse(to_json(options.surface));
  json["surface"]["r_max"] = report.r_max;
  json["surface"]["r_max_reason"] = to_string(report.r_max_limit);
  json["surface"]["extension_deg"] = report.extension_deg;
  json["surface"]["branches"] = branches_json(report);
  json["limits_hit"] = refine.limits_hit;
  json["warnings"] = report.warnings;
  json["dropped_extensions"] = report.dropped_extensions;
  json["dropped_extras"] = report.dropped_extras;
  json["version"] = DOMEWARP_VERSION;
  if (!report.input.empty()) json["files"] = {{"input", report.input}, {"output", report.output}};
  if (!report.animation.empty()) json["pose"] = {{"animation", report.animation}, {"time_s", report.time}};
  json["size"] = {options.raster.width, options.raster.height};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; // file names need not be UTF-8
}

std::string to_text(const ConvertReport& report, const ConvertOptions& options) {
  const RefineReport& refine = report.refine;
  std::ostringstream text;
  if (refine.lines_in + refine.points_in > 0)
    text << "lines       " << refine.lines_in << " in, " << refine.lines_out << " out; points " << refine.points_in << " in, "
         << refine.points_out << " out\n";
  text << "triangles   " << refine.triangles_in << " in, " << refine.triangles_out << " out ("
       << culled(refine.skipped) << " culled, " << refine.triangles_clipped
       << " clipped), " << refine.vertices << " vertices\n"
       << std::setprecision(3);
  if (options.refine.subdivision == Subdivision::isotropic)
    text << "isotropic   " << refine.isotropic.points << " points as the thesis counts them, " << refine.isotropic.divisions
         << " divisions; neither error nor cracks are bounded\n";
  else
    text << "error       at most " << refine.error_px_max << " px (tolerance " << options.refine.tolerance_px << "), mean "
         << refine.error_px_mean << " px; depth " << 100 * refine.depth_error_max << " %"
         << (depth_decides(refine, options.refine) ? " (--depth-tolerance decides here)" : "") << "\n"
         << "cracks      " << refine.open_edges << " open edges that the source did not have; " << refine.t_junctions_in
         << " T-junctions of the source mended\n";
  if (report.packing_px > 0)
    text << "packing     moves points by at most " << report.packing_px << " px more; " << report.packing_mended << " triangles turned back, " << report.packing_turned
         << " left turned over\n";
  text << "map         " << method_text(report, options) << "\n";
  text << std::fixed << std::setprecision(0) << "time        " << report.total_ms << " ms, peak memory " << report.peak_memory_mb << " MB\n";
  for (const std::string& limit : refine.limits_hit) text << "stopped by  " << limit << "\n";
  return text.str();
}

} // namespace domewarp
