// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/surface.h"

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "reference_curves.h"

namespace domewarp {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double corner = 5.0 / 3; // of a 4:3 picture

SurfaceOptions curve_options(const std::string& text) {
  SurfaceOptions options;
  options.curve = text;
  return options;
}

SurfaceOptions lens_options(Lens lens, double fov_deg) {
  SurfaceOptions options;
  options.lens = lens;
  options.fov_deg = fov_deg;
  return options;
}

std::string complaint(const SurfaceOptions& options, double screen = corner) {
  try {
    const Surface surface(options, screen);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    return error.what();
  }
  return "";
}

Vec3 towards(double theta) { return {std::sin(theta), 0, -std::cos(theta)}; }

double degrees(double radians) { return radians * 180 / pi; }

TEST(Surface, ShowsTheFourBranchesOfFigure21b) {
  const Surface surface(curve_options("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1"), corner);
  const std::vector<Branch>& branches = surface.branches();
  ASSERT_EQ(branches.size(), 4u);
  const double turns[] = {19.49, 17.12, 17.89};
  for (int i = 0; i < 4; ++i) EXPECT_EQ(branches[i].orientation, i % 2 == 0 ? 1 : -1);
  EXPECT_NEAR(degrees(branches[0].theta_high), turns[0], 5e-3);
  EXPECT_NEAR(degrees(branches[1].theta_high), turns[0], 5e-3);
  EXPECT_NEAR(degrees(branches[1].theta_low), turns[1], 5e-3);
  EXPECT_NEAR(degrees(branches[2].theta_high), turns[2], 5e-3);
  EXPECT_TRUE(branches[0].fold_high && branches[1].fold_low && branches[1].fold_high && branches[3].fold_high);
  EXPECT_FALSE(branches[0].fold_low || branches[3].fold_low);
  EXPECT_EQ(surface.r_max_limit(), RadiusLimit::screen);
  EXPECT_EQ(surface.branch_at(0.2), 0u);
  EXPECT_EQ(surface.branch_at(0.6), 1u);
  EXPECT_EQ(surface.branch_at(0.9), 2u);
  EXPECT_EQ(surface.branch_at(1.5), 3u);
}

TEST(Surface, FirstBranchEndsAtTheFold) {
  SurfaceOptions options = curve_options("-tanh(r-1)");
  EXPECT_EQ(Surface(options, 3).branches().size(), 2u);
  options.branches = BranchChoice::first;
  const Surface surface(options, 3);
  ASSERT_EQ(surface.branches().size(), 1u);
  EXPECT_EQ(surface.r_max_limit(), RadiusLimit::fold);
  EXPECT_NEAR(surface.r_max(), 2.0622, 5e-5);
  EXPECT_NEAR(degrees(surface.branches()[0].theta_high), 110.88, 5e-3);
}

TEST(Surface, RMaxIsTheSmallestLimitAndSaysWhich) {
  const auto limit = [](SurfaceOptions options, double screen) {
    const Surface surface(options, screen);
    return std::pair(surface.r_max(), surface.r_max_limit());
  };
  EXPECT_EQ(limit(curve_options("1-r^2"), corner), std::pair(corner, RadiusLimit::screen));
  EXPECT_EQ(limit(curve_options("sqrt(1-r^2)"), corner), std::pair(1.0, RadiusLimit::domain));
  SurfaceOptions user = curve_options("1-r^2");
  user.rmax = 0.8;
  EXPECT_EQ(limit(user, corner), std::pair(0.8, RadiusLimit::user));
  user.rmax = 80;
  EXPECT_EQ(limit(user, corner), std::pair(corner, RadiusLimit::screen));
  EXPECT_EQ(limit(lens_options(Lens::equidistant, 180), corner), std::pair(1.0, RadiusLimit::lens));
  EXPECT_EQ(limit(lens_options(Lens::equidistant, 180), 0.5), std::pair(0.5, RadiusLimit::screen));
  SurfaceOptions projector = curve_options("1+5*r");
  projector.projector = 1;
  const auto [asymptote, reason] = limit(projector, corner);
  EXPECT_NEAR(asymptote, 0.2, 1e-3);
  EXPECT_EQ(reason, RadiusLimit::projector);
  // R_c = r / (f + 1) turns where h + 1 = 0: r^2 = 2 for f = 1 + r^2.
  projector.curve = "1+r^2";
  EXPECT_NEAR(limit(projector, corner).first, std::sqrt(2) / 4, 1e-12);
  EXPECT_EQ(limit(projector, corner).second, RadiusLimit::projector);
}

TEST(Surface, TheProjectorIsCompensatedBothWays) {
  SurfaceOptions options = curve_options("1-r^2");
  options.projector = 1;
  const Surface surface(options, corner);
  // Erratum 15: the image radius 0.5 lights the surface where r / (2 - r^2) = 0.5.
  const Vec2 point = *surface.meridian(0.5);
  EXPECT_NEAR(point.x, std::sqrt(3) - 1, 1e-15);
  EXPECT_NEAR(point.x / (point.y + 1), 0.5, 1e-15);
  const Vec2 way = *surface.direction(0.5);
  EXPECT_NEAR(way.x / way.y, point.x / point.y, 1e-14);
  EXPECT_NEAR(surface.radius(0, way.x, way.y), 0.5, 1e-15);
  // Erratum 16: the corner of the picture shows r = 1.146.
  EXPECT_NEAR(surface.meridian(corner)->x, 1.146, 5e-4);
}

TEST(Surface, ALensAndItsProfileCurveAreTheSameSurface) {
  const std::pair<SurfaceOptions, SurfaceOptions> pairs[] = {
      {lens_options(Lens::orthographic, 180), curve_options("sqrt(1-r^2)")},
      {lens_options(Lens::equidistant, 180), curve_options("r/tan(r*pi/2)")},
      {lens_options(Lens::stereographic, 180), curve_options("0.5*(1-r^2)")},
  };
  for (auto [lens, curve] : pairs)
    for (const double distance : {0.0, 0.5, 2.0}) {
      lens.rmax = curve.rmax = 0.9;
      if (distance > 0) lens.projector = curve.projector = distance;
      const Surface a(lens, corner), b(curve, corner);
      EXPECT_NEAR(a.r_max(), b.r_max(), 1e-15);
      EXPECT_NEAR(a.branches()[0].theta_high, b.branches()[0].theta_high, 1e-14);
      EXPECT_NEAR(a.blind().theta_low, b.blind().theta_low, 1e-12);
      for (double theta = 0; theta < a.branches()[0].theta_high; theta += 0.01) {
        const double s = std::sin(theta), c = std::cos(theta);
        EXPECT_NEAR(a.radius(0, s, c), b.radius(0, s, c), 2e-15);
        const RadialJet ja = a.radial(0, theta), jb = b.radial(0, theta);
        EXPECT_NEAR(ja.dr, jb.dr, 1e-11);
        EXPECT_NEAR(ja.d2r, jb.d2r, 1e-8);
      }
      for (double theta = a.branches()[0].theta_high + 1e-3; theta < pi; theta += 0.01) {
        const auto ra = a.extended_radius(towards(theta));
        const auto rb = b.extended_radius(towards(theta));
        ASSERT_EQ(ra.has_value(), rb.has_value()) << theta;
        if (ra) {
          EXPECT_NEAR(*ra, *rb, 1e-9 * *ra * *ra);
        }
      }
    }
}

TEST(Surface, DerivativesAgreeWithDifferencesOfTheRadius) {
  SurfaceOptions compensated = curve_options("2-(r+0.01)^r");
  compensated.projector = 1;
  for (const SurfaceOptions& options :
       {curve_options("1-r^2"), curve_options("-log(r+0.1)"), curve_options("sqrt(1-r^2)"), curve_options("-1+r^2"),
        curve_options("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1"), compensated}) {
    const Surface surface(options, corner);
    for (std::size_t i = 0; i < surface.branches().size(); ++i) {
      const Branch& branch = surface.branches()[i];
      const double width = branch.theta_high - branch.theta_low;
      for (int k = 1; k < 20; ++k) {
        const double theta = branch.theta_low + width * k / 20, h = 1e-4 * width;
        const auto r = [&](int j) { return surface.radius(i, std::sin(theta + j * h), std::cos(theta + j * h)); };
        const RadialJet jet = surface.radial(i, theta);
        EXPECT_NEAR(jet.r, r(0), 1e-15 * (1 + std::abs(jet.dr)));
        EXPECT_NEAR(jet.dr, (r(1) - r(-1)) / (2 * h), 1e-5 * (1 + std::abs(jet.dr))) << options.curve;
        EXPECT_NEAR(jet.d2r, (r(1) + r(-1) - 2 * r(0)) / (h * h), 1e-4 * (1 + std::abs(jet.d2r))) << options.curve;
      }
    }
  }
}

TEST(Surface, DirectionsBeyondABranchGetItsNearerEnd) {
  const Surface surface(curve_options("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1"), corner);
  for (std::size_t i = 0; i < surface.branches().size(); ++i) {
    const Branch& branch = surface.branches()[i];
    for (const double theta : {branch.theta_high + 0.1, branch.theta_high + 1, pi})
      EXPECT_EQ(surface.radius(i, std::abs(std::sin(theta)), std::cos(theta)), branch.radius_high) << i << " " << theta;
    if (branch.theta_low > 0) {
      EXPECT_EQ(surface.radius(i, 0, 1), branch.radius_low);
    }
    EXPECT_EQ(surface.radial(i, -1).r, branch.radius_low);
    EXPECT_EQ(surface.radial(i, 9).r, branch.radius_high);
  }
}

TEST(Surface, SlopesAtAFoldAreFinite) {
  const Surface surface(curve_options("-tanh(r-1)"), 3);
  const RadialJet rising = surface.radial(0, surface.branches()[0].theta_high);
  const RadialJet falling = surface.radial(1, surface.branches()[1].theta_high);
  EXPECT_TRUE(std::isfinite(rising.dr) && std::isfinite(rising.d2r) && std::isfinite(falling.dr));
  EXPECT_GT(std::abs(rising.dr), 1e6);
}

TEST(Surface, AVerticalTangentHasSmoothSlopes) {
  const Surface surface(curve_options("sqrt(1-r^2)"), corner);
  const Branch& branch = surface.branches()[0];
  EXPECT_EQ(branch.theta_high, pi / 2);
  for (const double gap : {0.0, 1e-12, 1e-9, 1e-7, 1e-4, 0.1}) {
    const RadialJet jet = surface.radial(0, pi / 2 - gap);
    EXPECT_NEAR(jet.r, std::cos(gap), 1e-15);
    EXPECT_NEAR(jet.dr, std::sin(gap), 1e-7) << gap;
    EXPECT_NEAR(jet.d2r, -std::cos(gap), 1e-3) << gap;
  }
}

TEST(Surface, TheTangentExtensionIsThatOfEquation16) {
  const Surface surface(curve_options("1-r^2"), corner);
  const double slope = -2 * corner, z = 1 - corner * corner;
  EXPECT_NEAR(surface.blind().theta_low, pi / 2 - std::atan(slope), 1e-14);
  for (double theta = surface.branches()[0].theta_high + 1e-6; theta < pi; theta += 0.01) {
    const auto radius = surface.extended_radius(towards(theta));
    ASSERT_EQ(radius.has_value(), theta < surface.blind().theta_low) << theta;
    if (radius) {
      EXPECT_NEAR(*radius, (slope * corner - z) / (slope - 1 / std::tan(theta)), 1e-12 * *radius * *radius);
    }
  }
  EXPECT_FALSE(surface.extended_radius({0, 0, 1}));
}

TEST(Surface, TheExtensionIsExactInEveryDirectionAndAtEveryLength) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  for (const std::optional<double> projector : {std::optional<double>(), std::optional<double>(3), std::optional<double>(0.5)}) {
    SurfaceOptions options = curve_options("1-r^2");
    options.projector = projector;
    options.rmax = 0.7;
    const Surface surface(options, corner);
    const long double rim = surface.rim().point.x, z = 1 - rim * rim, slope = -2 * rim, d = projector.value_or(0);
    int extended = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 p = Vec3(normal(random), normal(random), normal(random)) * std::pow(10.0, i % 3 == 0 ? 100 * normal(random) : 0);
      const long double s = std::hypot(static_cast<long double>(p.x), static_cast<long double>(p.y)), c = -p.z;
      const long double slant = c - s * slope, along = (z - rim * slope) / slant, depth = c * along + d;
      if (std::abs(s * along - rim) < 1e-9L || std::abs(slant) < 1e-4L * s || (projector && std::abs(depth) < 1e-4L)) continue;
      const auto radius = surface.extended_radius(p);
      const bool expected = slant > 0 && s * along > rim && (!projector || depth > 0);
      ASSERT_EQ(radius.has_value(), expected) << p.x << " " << p.y << " " << p.z;
      if (!expected) continue;
      const auto image = static_cast<double>(projector ? s * along * d / depth : s * along);
      EXPECT_NEAR(*radius / image, 1, 1e-13);
      ++extended;
    }
    EXPECT_GT(extended, 1000);
  }
}

TEST(Surface, AVerticalTangentExtendsAlongItself) {
  const Surface surface(curve_options("sqrt(1-r^2)"), corner);
  EXPECT_EQ(surface.blind().theta_low, pi);
  for (const double theta : {1.6, 2.0, 3.0, 3.14})
    EXPECT_NEAR(*surface.extended_radius(towards(theta)), 1, 1e-15);
  EXPECT_FALSE(surface.extended_radius({0, 0, 1}));
}

TEST(Surface, BeyondAFoldAllIsBlind) {
  SurfaceOptions options = curve_options("-tanh(r-1)");
  options.branches = BranchChoice::first;
  const Surface surface(options, 3);
  const double end = surface.branches()[0].theta_high;
  EXPECT_EQ(surface.blind().theta_low, end);
  for (double theta = end + 1e-9; theta <= pi; theta += 0.01)
    EXPECT_FALSE(surface.extended_radius(towards(theta))) << "erratum 8: the image centre";
}

TEST(Surface, AFlatPictureIsRectilinear) {
  const Surface surface(curve_options("1"), corner);
  for (double theta = 0; theta < 1; theta += 0.01)
    EXPECT_NEAR(surface.radius(0, std::sin(theta), std::cos(theta)), std::tan(theta), 4e-16 * (1 + std::tan(theta)));
  EXPECT_NEAR(surface.blind().theta_low, pi / 2, 1e-15);
}

TEST(Surface, ARemovableSingularityOnTheAxisIsRemoved) {
  const Surface surface(curve_options(fisheye_curve().text), corner);
  EXPECT_NEAR(degrees(surface.branches()[0].theta_high), 150, 1e-12);
  for (double theta = 1e-9; theta < 2.6; theta = theta * 1.1)
    EXPECT_NEAR(surface.radius(0, std::sin(theta), std::cos(theta)), theta * 2 / pi, 2e-15 * theta) << theta;
  EXPECT_NE(complaint(curve_options("log(r)/log(r)+1/r")), "");
}

TEST(Surface, AMeasuredProfileIsASurface) {
  SurfaceOptions options;
  for (int i = 0; i <= 200; ++i) options.profile.emplace_back(0.005 * i, 1 - 2.5e-5 * i * i);
  options.profile_name = "dome.txt";
  const Surface measured(options, corner), exact(curve_options("1-r^2"), 1);
  EXPECT_EQ(measured.r_max_limit(), RadiusLimit::domain);
  EXPECT_EQ(measured.r_max(), 1);
  EXPECT_EQ(measured.joints(0).size(), 199u);
  for (double theta = 0; theta < 1.5; theta += 0.01)
    EXPECT_NEAR(measured.radius(0, std::sin(theta), std::cos(theta)), exact.radius(0, std::sin(theta), std::cos(theta)),
                1e-5);
}

TEST(Surface, ADisplayBehindTheEyeFalls) {
  const Surface surface(curve_options("-1+r^2"), corner);
  ASSERT_EQ(surface.branches().size(), 1u);
  EXPECT_EQ(surface.branches()[0].theta_high, pi);
  EXPECT_EQ(surface.branches()[0].radius_high, 0);
  EXPECT_EQ(surface.branches()[0].orientation, -1);
  EXPECT_NEAR(surface.branches()[0].theta_low, std::atan2(corner, corner * corner - 1), 1e-15);
}

TEST(Surface, WhatCannotWorkIsRefusedWithTheReason) {
  const auto expect = [](const std::string& message, const std::string& option, const std::string& reason) {
    EXPECT_EQ(message.rfind(option, 0), 0u) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
  };
  expect(complaint(curve_options("log(-1)")), "--curve", "no finite value at r = 0");
  expect(complaint(curve_options("1/r")), "--curve", "no finite value at r = 0");
  expect(complaint(curve_options("r+")), "--curve", "column 3");
  expect(complaint(curve_options("")), "--curve", "empty");
  expect(complaint(curve_options("foo(r)")), "--curve", "'foo'");
  expect(complaint(curve_options("r^2")), "--curve", "eye on the surface");
  expect(complaint(curve_options("-1-r^2")), "--curve", "behind the eye");
  SurfaceOptions both = lens_options(Lens::equidistant, 180);
  both.curve = "1";
  expect(complaint(both), "--curve", "only one");
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    SurfaceOptions options = curve_options("1-r^2");
    options.rmax = bad;
    expect(complaint(options), "--rmax", "greater than 0");
    options = curve_options("1-r^2");
    options.projector = bad;
    expect(complaint(options), "--projector", "greater than 0");
    expect(complaint(lens_options(Lens::equisolid, bad)), "--fov", "equisolid");
  }
  SurfaceOptions behind = curve_options("-3+r^2");
  behind.projector = 1;
  expect(complaint(behind), "--projector", "behind the projector");
  SurfaceOptions rows;
  rows.profile = {{0, 1}, {0.5, 0.9}, {0.5, 0.8}};
  rows.profile_name = "dome.txt";
  expect(complaint(rows), "--profile: dome.txt", "twice");
}

TEST(Surface, ADomainTooSmallToHoldADirectionIsRefused) {
  EXPECT_NE(complaint(curve_options("sqrt(1-1e300*r)+1")).find("shows nothing"), std::string::npos);
  EXPECT_EQ(complaint(curve_options("sqrt(1-1e3*r)+1")), "");
}

} // namespace
} // namespace domewarp
