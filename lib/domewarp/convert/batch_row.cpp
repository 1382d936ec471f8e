// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/batch_row.h"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"

namespace domewarp {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 5> status_names = {"converted", "unkept", "refused", "failed", "unwritten"};
constexpr std::array<int, 5> exit_codes = {0, static_cast<int>(ErrorCode::unkept), static_cast<int>(ErrorCode::unkept),
                                           static_cast<int>(ErrorCode::input), static_cast<int>(ErrorCode::output)};

} // namespace

const char* to_string(BatchStatus status) { return status_names[static_cast<std::size_t>(status)]; }

int exit_code(BatchStatus status) { return exit_codes[static_cast<std::size_t>(status)]; }

std::string to_json(const BatchRow& row) {
  const Json json = {{"input", row.input.string()},
                     {"output", row.output.string()},
                     {"status", to_string(row.status)},
                     {"up_to_date", row.up_to_date},
                     {"exit_code", exit_code(row.status)},
                     {"message", row.message},
                     {"triangles", {{"input", row.triangles_in}, {"output", row.triangles_out}}},
                     {"error_px", row.status == BatchStatus::converted || row.status == BatchStatus::unkept ? Json(row.error_px) : Json()},
                     {"tolerance_px", row.tolerance_px},
                     {"seconds", row.seconds},
                     {"warnings", row.warnings}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace); // file names need not be UTF-8
}

bool parse_row(const std::string& text, BatchRow& row) {
  try {
    const Json json = Json::parse(text);
    const auto name = std::find(status_names.begin(), status_names.end(), json.at("status").get<std::string>());
    if (name == status_names.end()) return false;
    row.status = static_cast<BatchStatus>(name - status_names.begin());
    row.message = json.at("message").get<std::string>();
    row.triangles_in = json.at("triangles").at("input").get<std::size_t>();
    row.triangles_out = json.at("triangles").at("output").get<std::size_t>();
    row.error_px = json.at("error_px").is_number() ? json["error_px"].get<double>() : 0;
    row.tolerance_px = json.at("tolerance_px").get<double>();
    row.seconds = json.at("seconds").get<double>();
    row.warnings = json.at("warnings").get<std::vector<std::string>>();
    return true;
  } catch (const Json::exception&) {
    return false;
  }
}

} // namespace domewarp
