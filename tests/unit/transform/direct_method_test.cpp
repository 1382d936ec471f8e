// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "domewarp/transform/image_map.h"
#include "surfaces.h"

namespace domewarp {
namespace {

/// Image radius of p by bisection in sixty digits between the branch's ends, without and with a projector.
Real reference_radius(const ReferenceCurve& curve, const Vec3& p, Real low, Real high, double distance) {
  const Real r = sqrt(Real(p.x) * Real(p.x) + Real(p.y) * Real(p.y)), z = -Real(p.z);
  const auto excess = [&](const Real& x) { return curve.value(x) * r - x * z; };
  const bool falls = excess(high) < Real(0);
  for (int i = 0; i < 190; ++i) {
    const Real middle = (low + high) / Real(2);
    const bool above = Real(0) < excess(middle);
    (above == falls ? low : high) = middle;
  }
  if (distance <= 0) return low;
  return low * Real(distance) / (curve.value(low) + Real(distance));
}

// Largest relative error of |image| over the branch, in units of how much a rounding of the direction moves it.
double worst_error(const ReferenceCurve& curve, double distance, int count, std::uint64_t seed) {
  std::optional<double> projector;
  if (distance > 0) projector = distance;
  const Surface surface = curve_surface(curve.text, projector, distance > 0 ? 0.9 : curve.end);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  double worst = 0;
  for (std::size_t i = 0; i < surface.branches().size(); ++i) {
    const BranchMap map(surface, i, Method::direct);
    const Branch& branch = surface.branches()[i];
    const double a = surface.meridian(branch.radius_low)->x, b = surface.meridian(branch.radius_high)->x;
    for (const double theta : branch_angles(branch, random, count)) {
      const double gap = std::min(theta - branch.theta_low, branch.theta_high - theta);
      if (gap <= 1e-14 * branch.theta_high) continue;
      const Vec3 p = towards(theta, 7 * uniform(random)) * std::exp2(40 * uniform(random) - 20);
      const RadialJet jet = surface.radial(i, theta);
      const double condition = std::max(1.0, std::abs(jet.dr / jet.r) * std::sin(theta));
      const Real expected = reference_radius(curve, p, Real(std::min(a, b)), Real(std::max(a, b)), distance);
      const Vec2 image = map.image(p);
      const Real radius = sqrt(Real(image.x) * Real(image.x) + Real(image.y) * Real(image.y));
      worst = std::max(worst, std::abs(static_cast<double>(radius / expected - Real(1))) / condition);
    }
  }
  return worst;
}

TEST(DirectMethod, AgreesWithSixtyDigits) {
  std::uint64_t seed = 100;
  for (const ReferenceCurve& curve : reference_curves()) {
    EXPECT_LT(worst_error(curve, 0, 100, seed++), 1e-13) << curve.text;
    EXPECT_LT(worst_error(curve, 1.5, 100, seed++), 1e-13) << curve.text << " with a projector";
  }
}

TEST(DirectMethod, TheReferenceWouldNoticeAnotherCurve) {
  ReferenceCurve wrong = reference_curves().front();
  wrong.text = "1-1.00000000001r^2";
  EXPECT_GT(worst_error(wrong, 0, 100, 1), 1e-13);
}

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
