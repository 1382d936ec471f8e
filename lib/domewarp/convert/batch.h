// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "domewarp/convert/batch_plan.h"
#include "domewarp/convert/batch_row.h"

namespace domewarp {

struct BatchOptions {
  std::filesystem::path out;     ///< made when it is not there
  int jobs = 0;                  ///< scenes at once; 0: as many as there are processors
  std::uint64_t max_memory = 0;  ///< bytes for all jobs together, 0: no limit; see estimate_memory
  bool force = false;            ///< convert what is up to date too
};

/// How far a batch has come.
struct BatchProgress {
  std::size_t done = 0, total = 0;
  double share = 0;              ///< of the bytes of the inputs that had to be converted, 0 to 1
};

struct BatchReport {
  std::vector<BatchRow> rows;    ///< in the order of the items
  int jobs = 0;                  ///< that ran at once
  double seconds = 0;
  double peak_memory_mb = 0;
};

/// Called when a scene is finished, one call at a time.
using BatchWatch = std::function<void(const BatchRow&, const BatchProgress&)>;

/// Converts the items that are not up to date, largest first, several at once, each with its share of the processors.
/// Whatever goes wrong with one of them ends in its row. Surfaces are analysed once for all scenes with equal options.
/// With a limit on memory a scene that alone needs more is refused, and others wait until there is room; one that
/// runs out of memory beside others is tried once more alone. Temporary files that a killed run has left are removed.
/// @throws Error(output) when the output folder cannot be made
BatchReport run_batch(const std::vector<BatchItem>& items, const BatchOptions& options, const BatchWatch& watch);

/// 4 if any output could not be written, else 3 if any broke a promise, else 2 if any could not be read, else 0.
int exit_code(const BatchReport& report);

} // namespace domewarp
