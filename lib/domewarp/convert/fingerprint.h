// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "domewarp/convert/batch_plan.h"

namespace domewarp {

/// Everything that decides the bytes of an output, hashed: the version, the options, the rows of a measured profile, and
/// the content of the input and of the files it refers to. 32 hexadecimal digits.
/// @throws Error(input) when the input cannot be read; a missing side file counts as empty
std::string fingerprint(const BatchItem& item);

} // namespace domewarp
