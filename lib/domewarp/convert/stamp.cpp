// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/stamp.h"

#include <system_error>

#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/survey.h"

namespace domewarp {

namespace fs = std::filesystem;

fs::path stamp_path(const fs::path& out, const fs::path& output) { return out / stamp_folder / (output.string() + ".json"); }

void write_stamp(const fs::path& out, const BatchRow& row, const std::string& fingerprint) {
  const fs::path path = stamp_path(out, row.output);
  make_folder(path.parent_path());
  nlohmann::ordered_json json;
  json["fingerprint"] = fingerprint;
  json["bytes"] = survey_file(out / row.output, false).file_bytes;
  json["scene"] = nlohmann::ordered_json::parse(to_json(row));
  write_file(path, json.dump() + "\n");
}

std::optional<BatchRow> read_stamp(const fs::path& out, const fs::path& output, const std::string& fingerprint) {
  const fs::path path = stamp_path(out, output);
  try {
    const std::vector<std::uint8_t> bytes = read_file(path);
    const auto json = nlohmann::ordered_json::parse(bytes.begin(), bytes.end());
    if (json.at("fingerprint") != fingerprint || json.at("bytes") != survey_file(out / output, false).file_bytes) return std::nullopt;
    BatchRow row;
    if (!parse_row(json.at("scene").dump(), row)) return std::nullopt;
    row.output = output;
    row.up_to_date = true;
    return row;
  } catch (const Error&) {
    return std::nullopt;
  } catch (const nlohmann::ordered_json::exception&) { // damaged: as if there were none
    return std::nullopt;
  }
}

} // namespace domewarp
