// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

/// Replaces every compressed view by a view of decoded bytes. @throws Error(input) when a stream is invalid.
void decode_meshopt(Document& document, Budget& budget);

} // namespace domewarp::gltf
