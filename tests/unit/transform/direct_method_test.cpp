// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "domewarp/transform/image_map.h"
#include "surfaces.h"

namespace domewarp {
namespace {

TEST(DirectMethod, TheFisheyeCurveIsTheEquidistantLens) {
  const Surface surface = curve_surface(fisheye_curve().text);
  const BranchMap map(surface, 0, Method::direct);
  for (double theta = 1e-12; theta < 2.6; theta = theta * 1.07) {
    const Real expected = Real(theta) * Real(2) / pi();
    EXPECT_NEAR(static_cast<double>(Real(map.image(towards(theta, 0)).x) / expected - Real(1)), 0, 2e-15) << theta;
  }
}

} // namespace
} // namespace domewarp
