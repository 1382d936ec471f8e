// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace domewarp {

/// Shortest decimal form that reads back as the same double, whatever the locale.
std::string to_text(double value);

/// @throws Error(usage) "option: what".
[[noreturn]] void refuse(std::string_view option, std::string_view what);

} // namespace domewarp
