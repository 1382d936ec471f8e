// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace domewarp {

enum class BatchStatus {
  converted,
  unkept,     ///< written, but the tolerance was not kept
  refused,    ///< would need more memory than allowed
  failed,     ///< the input cannot be read, or not with these options
  unwritten,  ///< the output cannot be written
};
const char* to_string(BatchStatus status);

/// What became of one scene of a batch.
struct BatchRow {
  std::filesystem::path input, output; ///< the output relative to the output folder
  BatchStatus status = BatchStatus::failed;
  bool up_to_date = false;             ///< an earlier run wrote it; figures are from then
  std::string message;                 ///< one sentence where something went wrong
  std::size_t triangles_in = 0, triangles_out = 0;
  double error_px = 0, tolerance_px = 0;
  double seconds = 0;
  std::vector<std::string> warnings;
};

/// The exit status that a single conversion of this kind has.
int exit_code(BatchStatus status);

/// One JSON object, and back. @throws nothing: text that makes no sense gives false
std::string to_json(const BatchRow& row);
bool parse_row(const std::string& json, BatchRow& row);

} // namespace domewarp
