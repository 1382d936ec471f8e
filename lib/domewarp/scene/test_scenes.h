// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/scene/scene.h"

namespace domewarp {

struct TestScene {
  std::string name;
  Scene scene;
};

/// The five bundled scenes, named after those of the founding thesis and with the counts of its Table 1
/// (drawn objects / triangles): cubes 8 / 336, pool 13 / 2020, hardware 20 / 4848, toys 86 / 6934, biology 15 / 17242.
/// Metres, +Y up, counter-clockwise outward (inward for rooms), unit normals everywhere; the cameras stand inside.
/// The same numbers on every machine: only operations that IEEE 754 rounds exactly are used, positions lie on a grid of
/// 2^-14, normals, texture coordinates and colours on one of 2^-12. Pictures are the same sample for sample; their PNG
/// bytes also depend on the release of zlib.
std::vector<TestScene> make_test_scenes();

} // namespace domewarp
