// SPDX-License-Identifier: GPL-3.0-or-later
#include <sstream>

#include <nlohmann/json.hpp>

#include "domewarp/audit/inspect.h"

namespace domewarp {

namespace {

using Json = nlohmann::ordered_json;

Json cracks_json(const CrackReport& cracks) {
  return {{"provenance", cracks.exact_provenance ? "attribute" : "inverse"},
          {"source_known", cracks.source_known},
          {"torn_positions", cracks.torn_positions},
          {"open_edges", cracks.open_edges},
          {"t_junctions_out", cracks.t_junctions},
          {"max_gap_px", cracks.max_gap_px},
          {"mean_gap_px", cracks.mean_gap_px},
          {"gap_area_px2", cracks.gap_area_px2},
          {"flips", cracks.flips}};
}

Json coverage_json(const CoverageReport& coverage) {
  return {{"samples", coverage.samples},
          {"lost", coverage.lost},
          {"lost_area_px2", coverage.lost_area_px2},
          {"overlapping", coverage.overlapping},
          {"error_px", {{"max", coverage.error_px_max}, {"mean", coverage.error_px_mean}}}};
}

class Rows {
public:
  template <typename Value>
  void add(const std::string& name, Value value, const char* note = "") {
    text_ << name << std::string(name.size() < 22 ? 22 - name.size() : 1, ' ') << value << note << "\n";
  }
  void heading(const std::string& name) { text_ << "\n" << name << "\n"; }
  std::string text() const { return text_.str(); }

private:
  std::ostringstream text_;
};

void add_cracks(Rows& rows, const CrackReport& cracks) {
  rows.heading(cracks.exact_provenance ? "against the source positions (_SOURCE_POSITION)" : "against the source positions, mapped back from the picture");
  if (cracks.exact_provenance) rows.add("torn positions", cracks.torn_positions);
  rows.add("open edges", cracks.open_edges, cracks.source_known ? " that the source did not have" : " (those of the source included; --source tells them apart)");
  rows.add("T-junctions", cracks.t_junctions);
  rows.add("largest gap", cracks.max_gap_px, " px");
  rows.add("mean gap", cracks.mean_gap_px, " px");
  rows.add("gap area", cracks.gap_area_px2, " px^2");
  rows.add("flipped triangles", cracks.flips);
}

void add_coverage(Rows& rows, const CoverageReport& coverage) {
  rows.heading("at " + std::to_string(coverage.samples) + " points of the source that the picture must show");
  rows.add("lost", coverage.lost);
  rows.add("lost area", coverage.lost_area_px2, " px^2");
  rows.add("overlapping", coverage.overlapping);
  rows.add("largest error", coverage.error_px_max, " px");
  rows.add("mean error", coverage.error_px_mean, " px");
}

} // namespace

std::string to_json(const InspectReport& report) {
  Json json = {{"triangles", report.triangles},
               {"vertices", report.vertices},
               {"unique_positions", report.unique_positions},
               {"open_edges", report.open_edges},
               {"non_manifold_edges", report.non_manifold_edges},
               {"boundary_loops", report.boundary_loops},
               {"euler_characteristic", report.euler_characteristic},
               {"t_junctions", report.t_junctions},
               {"degenerate", report.degenerate},
               {"duplicate", report.duplicate},
               {"max_gap", report.max_gap},
               {"meshes", report.meshes},
               {"instances", report.instances},
               {"primitives", report.primitives},
               {"materials", report.materials}};
  if (report.cracks) json["cracks"] = cracks_json(*report.cracks);
  if (report.coverage) json["coverage"] = coverage_json(*report.coverage);
  if (report.hausdorff)
    json["hausdorff"] = {{"distance_px", report.hausdorff->distance_px},
                         {"error_px", report.hausdorff->error_px},
                         {"exact_triangles", report.hausdorff->exact_triangles}};
  return json.dump(2) + "\n";
}

std::string to_text(const InspectReport& report) {
  Rows rows;
  rows.add("instances", report.instances);
  rows.add("meshes", report.meshes);
  rows.add("primitives", report.primitives);
  rows.add("materials", report.materials);
  rows.add("triangles", report.triangles);
  rows.add("vertices", report.vertices);
  rows.add("unique positions", report.unique_positions);
  rows.add("open edges", report.open_edges);
  rows.add("boundary loops", report.boundary_loops);
  rows.add("non-manifold edges", report.non_manifold_edges);
  rows.add("degenerate triangles", report.degenerate);
  rows.add("duplicate triangles", report.duplicate);
  rows.add("T-junctions", report.t_junctions);
  if (report.t_junctions > 0) rows.add("largest gap at one", report.max_gap, " scene units");
  if (report.cracks) add_cracks(rows, *report.cracks);
  if (report.coverage) add_coverage(rows, *report.coverage);
  if (report.hausdorff) {
    rows.heading("from " + std::to_string(report.hausdorff->exact_triangles) + " pieces of the exact warp");
    rows.add("Hausdorff distance", report.hausdorff->distance_px, " px or less");
  }
  return rows.text();
}

} // namespace domewarp
