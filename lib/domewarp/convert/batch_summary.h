// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "domewarp/convert/batch.h"

namespace domewarp {

/// Which part of a batch was run.
struct Shard {
  std::size_t index = 1, count = 1; ///< index from 1
};

/// JSON with stable keys: version, out, shard, jobs, seconds, peak_memory_mb, counts, triangles, scenes.
std::string to_json(const BatchReport& report, const std::filesystem::path& out, const Shard& shard);

/// A table of the counts.
std::string to_text(const BatchReport& report);

/// summary.json, or summary-K-of-N.json for a part.
std::filesystem::path summary_name(const Shard& shard);

} // namespace domewarp
