// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/scene/scene.h"

namespace domewarp::test_scenes {

/// One function per bundled scene, see make_test_scenes; every drawn node counts as one object.
Scene make_cubes();
Scene make_pool();
Scene make_hardware();
Scene make_toys();
Scene make_biology();

} // namespace domewarp::test_scenes
