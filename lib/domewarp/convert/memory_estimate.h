// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/gltf/survey.h"

namespace domewarp {

/// Bytes that a conversion will need at least, from what the file says of itself. Refinement may take more.
double estimate_memory(const FileSurvey& survey);

} // namespace domewarp
