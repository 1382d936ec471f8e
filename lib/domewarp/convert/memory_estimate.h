// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "domewarp/convert/convert.h"
#include "domewarp/gltf/survey.h"

namespace domewarp {

/// Bytes that a conversion will need at least, from what the file says of itself. Refinement may take more.
double estimate_memory(const FileSurvey& survey, const ConvertOptions& options);

/// Why a conversion that needs so many bytes is refused; empty when it fits.
/// @param max_memory   bytes, 0: no limit
std::string memory_refusal(double estimate, std::uint64_t max_memory);

/// The same when memory ran out on the way.
std::string memory_exhausted(std::uint64_t max_memory);

} // namespace domewarp
