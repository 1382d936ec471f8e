// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "domewarp/convert/convert.h"

namespace domewarp {

/// The report as JSON text with the stable keys of the README ("The report").
std::string to_json(const ConvertReport& report, const ConvertOptions& options);

/// The same in a few lines for people.
std::string to_text(const ConvertReport& report, const ConvertOptions& options);

} // namespace domewarp
