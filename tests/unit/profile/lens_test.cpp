// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/lens.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "domewarp/core/errors.h"

namespace domewarp {
namespace {

constexpr double pi = std::numbers::pi;
constexpr Lens lenses[] = {Lens::equidistant, Lens::equisolid, Lens::stereographic, Lens::orthographic};

double closed_form(Lens lens, double theta) {
  switch (lens) {
  case Lens::equidistant: return theta;
  case Lens::equisolid: return std::sin(theta / 2);
  case Lens::stereographic: return std::tan(theta / 2);
  default: return std::sin(theta);
  }
}

TEST(Lens, ItsEdgeFallsOnRadiusOne) {
  for (const Lens lens : lenses)
    for (const double fov : {1.0, 60.0, 179.0, 180.0, 270.0, 359.0}) {
      if (lens == Lens::orthographic && fov > 180) continue;
      const LensForm form = make_lens(lens, fov);
      const double half = fov * pi / 360;
      for (int i = 0; i <= 100; ++i) {
        const double theta = half * i / 100;
        const double expected = closed_form(lens, theta) / closed_form(lens, half);
        EXPECT_NEAR(radius(form, std::sin(theta), std::cos(theta)), expected, 1e-13);
        EXPECT_NEAR(radial(form, theta).r, expected, 1e-13);
        if (theta < pi / 2 - 0.01) {
          EXPECT_NEAR(angle(form, expected), theta, 1e-12);
        }
      }
    }
}

TEST(Lens, DerivativesAgreeWithDifferences) {
  for (const Lens lens : lenses) {
    const LensForm form = make_lens(lens, 170);
    for (double theta = 0.001; theta < 1.4; theta += 0.0137) {
      const double h = 1e-4;
      for (const auto function : {radial, depth}) {
        const RadialJet at = function(form, theta), before = function(form, theta - h),
                        after = function(form, theta + h);
        EXPECT_NEAR(at.dr, (after.r - before.r) / (2 * h), 1e-7);
        EXPECT_NEAR(at.d2r, (after.dr - before.dr) / (2 * h), 1e-6);
      }
    }
  }
}

TEST(Lens, DepthIsRadiusTimesCotangent) {
  for (const Lens lens : lenses) {
    const LensForm form = make_lens(lens, 170);
    for (double theta = 1e-5; theta < 1.5; theta *= 1.1)
      EXPECT_NEAR(depth(form, theta).r, radial(form, theta).r / std::tan(theta), 1e-11);
  }
}

TEST(Lens, FieldsOfViewOutOfRangeAreRefused) {
  for (const Lens lens : lenses)
    for (const double fov : {0.0, -10.0, 361.0, std::nan(""), HUGE_VAL})
      EXPECT_THROW(make_lens(lens, fov), Error) << fov;
  EXPECT_THROW(make_lens(Lens::stereographic, 360), Error);
  EXPECT_THROW(make_lens(Lens::orthographic, 180.001), Error);
  EXPECT_NO_THROW(make_lens(Lens::orthographic, 180));
  EXPECT_NO_THROW(make_lens(Lens::equisolid, 360));
}

} // namespace
} // namespace domewarp
