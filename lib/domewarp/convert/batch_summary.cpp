// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/batch_summary.h"

#include <array>
#include <iomanip>
#include <sstream>

#include <nlohmann/json.hpp>

namespace domewarp {

namespace {

using Json = nlohmann::ordered_json;

struct Counts {
  std::array<std::size_t, 5> status{};
  std::size_t up_to_date = 0, triangles_in = 0, triangles_out = 0;
  std::size_t of(BatchStatus s) const { return status[static_cast<std::size_t>(s)]; }
};

/// `status` counts what this run did; what was up to date is counted there alone, but for promises that stay broken.
Counts count(const BatchReport& report) {
  Counts counts;
  for (const BatchRow& row : report.rows) {
    counts.up_to_date += row.up_to_date;
    counts.status[static_cast<std::size_t>(row.status)] += !(row.up_to_date && row.status == BatchStatus::converted);
    counts.triangles_in += row.triangles_in;
    counts.triangles_out += row.triangles_out;
  }
  return counts;
}

} // namespace

std::string to_json(const BatchReport& report, const std::filesystem::path& out, const Shard& shard) {
  const Counts counts = count(report);
  Json json;
  json["version"] = DOMEWARP_VERSION;
  json["out"] = out.string();
  json["shard"] = {{"index", shard.index}, {"count", shard.count}};
  json["jobs"] = report.jobs;
  json["seconds"] = report.seconds;
  json["peak_memory_mb"] = report.peak_memory_mb;
  json["counts"] = {{"scenes", report.rows.size()}, {"up_to_date", counts.up_to_date}};
  for (const BatchStatus s : {BatchStatus::converted, BatchStatus::unkept, BatchStatus::refused, BatchStatus::failed, BatchStatus::unwritten})
    json["counts"][to_string(s)] = counts.of(s);
  json["triangles"] = {{"input", counts.triangles_in}, {"output", counts.triangles_out}};
  json["scenes"] = Json::array();
  for (const BatchRow& row : report.rows) json["scenes"].push_back(Json::parse(to_json(row)));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_text(const BatchReport& report) {
  const Counts counts = count(report);
  std::ostringstream text;
  text << "\n  scenes  converted  up to date  unkept  refused  failed  unwritten      seconds\n"
       << std::setw(8) << report.rows.size() << std::setw(11) << counts.of(BatchStatus::converted) << std::setw(12) << counts.up_to_date
       << std::setw(8) << counts.of(BatchStatus::unkept) << std::setw(9) << counts.of(BatchStatus::refused) << std::setw(8)
       << counts.of(BatchStatus::failed) << std::setw(11) << counts.of(BatchStatus::unwritten) << std::setw(13) << std::fixed
       << std::setprecision(1) << report.seconds << "\n";
  return text.str();
}

std::filesystem::path summary_name(const Shard& shard) {
  if (shard.count == 1) return "summary.json";
  return "summary-" + std::to_string(shard.index) + "-of-" + std::to_string(shard.count) + ".json";
}

} // namespace domewarp
