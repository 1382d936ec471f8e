// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace domewarp {

/// What long work tells whoever watches it: the name of the stage it is in ("read", "refine", ...) and the share of that
/// stage that is done, 0 to 1, or a negative number where it cannot be known. Called from any thread, from several at
/// once; empty when nobody watches. The library itself never prints.
using Progress = std::function<void(const char* stage, double done)>;

inline void tell(const Progress& progress, const char* stage, double done = -1) {
  if (progress) progress(stage, done);
}

} // namespace domewarp
