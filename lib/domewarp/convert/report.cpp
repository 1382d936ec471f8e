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
                        {"table", {{"pieces", table.pieces}, {"degree", table.degree}, {"max_error", table.max_error}, {"build_ms", table.build_ms}}}});
  }
  return branches;
}

} // namespace

std::string to_json(const ConvertReport& report, const ConvertOptions& options) {
  const RefineReport& refine = report.refine;
  Json json;
  json["triangles"] = {{"input", refine.triangles_in},
                       {"culled", refine.back_faces + refine.degenerate + refine.triangles_off_picture},
                       {"clipped", refine.triangles_clipped},
                       {"output", refine.triangles_out}};
  json["vertices"] = refine.vertices;
  json["tolerance_px"] = options.refine.tolerance_px;
  json["error_px"] = {{"max", refine.error_px_max}, {"p99", refine.error_px_p99}, {"mean", refine.error_px_mean}};
  json["depth_error_rel"] = {{"max", refine.depth_error_max}};
  json["cracks"] = {{"open_edges", refine.open_edges},
                    {"open_edges_in", refine.open_edges_in},
                    {"t_junctions_in", refine.t_junctions_in},
                    {"t_junctions_out", refine.t_junctions_out},
                    {"max_gap_px", refine.max_gap_px}};
  json["skipped"] = {{"back_faces", refine.back_faces},
                     {"degenerate", refine.degenerate},
                     {"off_picture", refine.triangles_off_picture}};
  json["refinement"] = {{"levels", refine.levels},
                        {"map_evaluations", refine.map_evaluations},
                        {"uncertified_edges", refine.uncertified_edges},
                        {"near", refine.near}};
  json["time_ms"] = {{"map", report.map_ms},
                     {"topology", refine.soup_ms},
                     {"refine", refine.levels_ms},
                     {"emit", refine.emit_ms},
                     {"total", report.total_ms}};
  json["peak_memory_mb"] = report.peak_memory_mb;
  json["surface"] = Json::parse(to_json(make_record(options, report)))["surface"];
  json["surface"]["r_max"] = report.r_max;
  json["surface"]["r_max_reason"] = to_string(report.r_max_limit);
  json["surface"]["branches"] = branches_json(report);
  json["limits_hit"] = refine.limits_hit;
  json["warnings"] = report.warnings;
  json["dropped_extensions"] = report.dropped_extensions;
  return json.dump(2) + "\n";
}

std::string to_text(const ConvertReport& report, const ConvertOptions& options) {
  const RefineReport& refine = report.refine;
  std::ostringstream text;
  text << "triangles   " << refine.triangles_in << " in, " << refine.triangles_out << " out ("
       << refine.back_faces + refine.degenerate + refine.triangles_off_picture << " culled, " << refine.triangles_clipped
       << " clipped), " << refine.vertices << " vertices\n"
       << std::setprecision(3) << "error       at most " << refine.error_px_max << " px (tolerance " << options.refine.tolerance_px
       << "), mean " << refine.error_px_mean << " px; depth " << 100 * refine.depth_error_max << " %\n"
       << "cracks      " << refine.open_edges << " open edges that the source did not have; " << refine.t_junctions_in
       << " T-junctions of the source mended\n"
       << std::fixed << std::setprecision(0) << "time        " << report.total_ms << " ms, peak memory " << report.peak_memory_mb << " MB\n";
  for (const std::string& limit : refine.limits_hit) text << "stopped by  " << limit << "\n";
  return text.str();
}

} // namespace domewarp
