// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace domewarp {

/// What is wrong with a first word that is no option and no command; empty when nothing is.
std::string unknown_command(const CLI::App& app, const std::string& word);

/// What is wrong with a line of which something was left over when it was parsed: the first option that its command does not
/// have and the one that was probably meant, else the first word too many.
std::string left_over(const CLI::App& app);

} // namespace domewarp
