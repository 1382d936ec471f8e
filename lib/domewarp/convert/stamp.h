// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "domewarp/convert/batch_row.h"

namespace domewarp {

/// The folder below an output folder where a batch notes what it has made.
inline constexpr const char* stamp_folder = ".domewarp";

/// Where a batch notes how an output was made: OUT/.domewarp/<output>.json.
std::filesystem::path stamp_path(const std::filesystem::path& out, const std::filesystem::path& output);

/// Notes that `row` is what a fingerprint gave. Called after the output was written, so that a run that is killed in between
/// does it again. @throws Error(output)
void write_stamp(const std::filesystem::path& out, const BatchRow& row, const std::string& fingerprint);

/// What was noted of an output, if it was made from this fingerprint and is still there in full (size of the file and of
/// those it refers to).
std::optional<BatchRow> read_stamp(const std::filesystem::path& out, const std::filesystem::path& output, const std::string& fingerprint);

} // namespace domewarp
