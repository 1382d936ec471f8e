// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "domewarp/convert/batch_plan.h"

namespace CLI {
class App;
}

namespace domewarp {

/// Options of a conversion from arguments, by the very table of options that the command line has (options.h).
/// @throws Error(usage) "WHERE: what is wrong with the value" for an argument that no such option takes, or that makes no
///         surface; the sentence alone when something is missing
JobOptions parse_arguments(const std::vector<JobArgument>& arguments);

/// @throws Error(usage) for an option given to `convert` that does nothing without another one, or that another one overrules
void require_use(const std::vector<JobArgument>& given);

/// Those options of a parsed command line that decide a conversion.
std::vector<JobArgument> given_arguments(const CLI::App& command);

} // namespace domewarp
