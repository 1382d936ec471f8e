// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "domewarp/scene/scene.h"

namespace domewarp::bench {

/// A cave around the eye of about this many triangles, with normals and texture coordinates.
Scene cave(std::size_t triangles);

/// A bundled scene by its name. @throws Error(usage) when there is none
Scene bundled(const std::string& name);

/// The closed box x in [-3.1, 2.7], y in [-1.6, 1.9], z in [-6.3, 2.2] around the eye: 12 triangles, seen from inside.
Scene box();

} // namespace domewarp::bench
