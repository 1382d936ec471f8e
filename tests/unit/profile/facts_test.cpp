// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/facts.h"

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/profile/plot.h"
#include "random_expression.h"

namespace domewarp {
namespace {

constexpr double pi = std::numbers::pi;

Surface curve_surface(const std::string& text, double screen = 5.0 / 3, double projector = 0) {
  SurfaceOptions options;
  options.curve = text;
  if (projector > 0) options.projector = projector;
  return {options, screen};
}

Vec3 towards(double theta) { return {std::sin(theta), 0, -std::cos(theta)}; }

double degrees(double radians) { return radians * 180 / pi; }

void expect_blind(const Surface& surface, double from, double to) {
  EXPECT_NEAR(degrees(surface.blind().theta_low), from, 1e-9) << name_of(surface);
  EXPECT_NEAR(degrees(surface.blind().theta_high), to, 1e-9) << name_of(surface);
}

TEST(Facts, TheBlindConeIsOnTheSideTheSurfaceLeavesOpen) {
  expect_blind(curve_surface("1-r^2"), 90 + degrees(std::atan(10.0 / 3)), 180);
  expect_blind(curve_surface("1"), 90, 180);
  expect_blind(curve_surface("sqrt(1-r^2)"), 180, 180);
  expect_blind(curve_surface("-1+r^2"), 0, degrees(std::atan(3.0 / 10)));
  // The outermost branch comes back from the fold: what it would extend over is visible already.
  const Surface folded = curve_surface("-tanh(r-1)", 3);
  expect_blind(folded, degrees(folded.branches()[0].theta_high), 180);
}

TEST(Facts, TheBlindConeAgreesWithWhatIsExtended) {
  for (const Surface& surface :
       {curve_surface("1-r^2"), curve_surface("-1+r^2"), curve_surface("-tanh(r-1)", 3), curve_surface("1-r^2", 1, 2),
        curve_surface("-1-0.5*r", 5.0 / 3, 4), curve_surface("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1"),
        curve_surface("1+r^2", 5.0 / 3, 1)}) {
    const Vec2 visible = visible_range(surface);
    const BlindCone blind = surface.blind();
    for (int i = 1; i < 2000; ++i) {
      const double theta = pi * i / 2000;
      const bool seen = theta >= visible.x && theta <= visible.y;
      const bool shown = seen || surface.extended_radius(towards(theta)).has_value();
      ASSERT_EQ(shown, !(theta > blind.theta_low && theta < blind.theta_high)) << name_of(surface) << " " << theta;
    }
  }
}

TEST(Facts, TheFieldOfViewIsThatOfTheVisibleCone) {
  EXPECT_NEAR(degrees(field_of_view(curve_surface("sqrt(1-r^2)"))), 180, 1e-12);
  EXPECT_NEAR(degrees(field_of_view(curve_surface("1-2.5*r^2"))), 328.676, 1e-3) << "the thesis calls it 330 degrees";
  EXPECT_NEAR(degrees(field_of_view(curve_surface("1"))), 2 * degrees(std::atan(5.0 / 3)), 1e-12);
  EXPECT_NEAR(degrees(field_of_view(curve_surface("-1"))), 2 * degrees(std::atan(5.0 / 3)), 1e-12);
}

TEST(Facts, KinksSayWhatTheyAre) {
  const Surface corner = curve_surface("1-abs(r-.37)");
  ASSERT_EQ(corner.kinks().size(), 1u);
  EXPECT_EQ(corner.kinks()[0].kind, KinkKind::corner);
  EXPECT_NEAR(corner.kinks()[0].r, 0.37, 1e-15);
  EXPECT_NEAR(corner.kinks()[0].theta, std::atan2(0.37, 1), 1e-15);
  const Surface knee = curve_surface("sqrt(abs(1-r^2))");
  ASSERT_EQ(knee.kinks().size(), 1u);
  EXPECT_EQ(knee.kinks()[0].kind, KinkKind::vertical_tangent);
  EXPECT_NEAR(degrees(knee.kinks()[0].theta), 90, 2e-6) << "an ulp of r is 1.5e-8 of theta";
  SurfaceOptions rows;
  rows.profile = {{0, 1}, {0.5, 0.8}, {1, 0.1}};
  const Surface measured(rows, 1);
  ASSERT_EQ(measured.kinks().size(), 1u);
  EXPECT_EQ(measured.kinks()[0].kind, KinkKind::joint);
}

TEST(Facts, TheReasonForRMaxIsNamed) {
  const auto reason = [](const Surface& surface, const std::string& words) {
    EXPECT_NE(explain_r_max(surface).find(words), std::string::npos) << explain_r_max(surface);
  };
  reason(curve_surface("1-r^2"), "corners");
  reason(curve_surface("sqrt(1-r^2)"), "beyond r = 1, where its tangent is vertical");
  reason(curve_surface("1-tan(r)"), "beyond r = 1.5708");
  reason(curve_surface("1+r^2", 5.0 / 3, 1), "touch the surface at r = 1.41421");
  reason(curve_surface("1+5*r", 5.0 / 3, 1), "however far");
  SurfaceOptions options;
  options.curve = "-tanh(r-1)";
  options.branches = BranchChoice::first;
  reason(Surface(options, 3), "turns there, at 110.876 degrees");
  options.rmax = 0.5;
  reason(Surface(options, 3), "--rmax");
  SurfaceOptions lens;
  lens.lens = Lens::equisolid;
  lens.fov_deg = 270;
  reason(Surface(lens, 2), "135 degrees");
  SurfaceOptions rows;
  rows.profile = {{0, 1}, {0.5, 0.8}};
  reason(Surface(rows, 2), "rows end at r = 0.5");
}

TEST(Facts, TheProjectorHidesWhatItsRaysTouch) {
  // 1 + r^2 seen from z = -1: the ray touches where h + 1 = 2 - r^2 = 0.
  EXPECT_NEAR(curve_surface("1+r^2", 5.0 / 3, 1).hidden_from(), std::sqrt(2), 1e-15);
  EXPECT_EQ(curve_surface("1-r^2", 5.0 / 3, 1).hidden_from(), HUGE_VAL);
  EXPECT_EQ(explain_projector(curve_surface("1-r^2")), "");
}

TEST(Facts, TheDomainIsFoundBeyondThePicture) {
  EXPECT_EQ(find_domain(curve_surface("2+sqrt(9-r^2)")).end, 3);
  const Domain endless = find_domain(curve_surface("1-r^2"));
  EXPECT_EQ(endless.end, endless.searched_to);
}

// Pixel positions along the first path drawn in a style.
std::vector<Vec2> drawn_path(const std::string& svg, const std::string& style) {
  const std::size_t at = svg.find(style);
  EXPECT_NE(at, std::string::npos) << style;
  const std::size_t start = svg.rfind("d=\"", at) + 3;
  std::vector<Vec2> path;
  for (std::size_t i = start; svg[i] != '"';) {
    std::size_t used = 0;
    const double x = std::stod(svg.substr(i + 1, 40), &used);
    i += 1 + used;
    const double y = std::stod(svg.substr(i, 40), &used);
    i += used;
    path.emplace_back(x, y);
  }
  return path;
}

TEST(Plot, TheRedCurveIsTheMeridian) {
  const std::string svg = plot_svg(curve_surface("1-r^2"));
  const std::vector<Vec2> plane = drawn_path(svg, "stroke=\"#222\" stroke-width=\"4\"");
  const std::vector<Vec2> red = drawn_path(svg, "stroke=\"#c8102e\" stroke-width=\"3\"");
  ASSERT_EQ(plane.size(), 2u);
  const double scale = (plane[1].x - plane[0].x) / (10.0 / 3), axis = 0.5 * (plane[0].x + plane[1].x);
  EXPECT_GT(red.size(), 30u);
  for (const Vec2& p : red) {
    const double r = std::abs(p.x - axis) / scale, z = (plane[0].y - p.y) / scale;
    EXPECT_NEAR(z, 1 - r * r, 0.1 / scale * 4);
  }
  EXPECT_NEAR(std::abs(red.back().x - axis) / scale, 5.0 / 3, 1e-3);
}

TEST(Plot, HostileNamesCannotLeaveTheirText) {
  SurfaceOptions rows;
  rows.profile = {{0, 1}, {0.5, 0.8}};
  rows.profile_name = "</text><script>alert(1)</script>&\"\xff\n";
  const std::string svg = plot_svg(Surface(rows, 2));
  EXPECT_EQ(svg.find("<script"), std::string::npos);
  EXPECT_NE(svg.find("&lt;/text&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;??"), std::string::npos);
}

TEST(Plot, EverySurfaceThatIsAcceptedCanBePlotted) {
  std::mt19937_64 random(2027);
  int plotted = 0;
  for (int i = 0; i < 300; ++i) {
    SurfaceOptions options;
    options.curve = random_text(random, 1 + static_cast<int>(random() % 4));
    if (random() % 3 == 0) options.projector = std::exp2(static_cast<double>(random() % 40) - 20);
    if (random() % 5 == 0) options.rmax = std::exp2(static_cast<double>(random() % 40) - 20);
    try {
      const std::string svg = plot_svg(Surface(options, 5.0 / 3));
      EXPECT_EQ(svg.find("nan"), std::string::npos) << options.curve;
      EXPECT_EQ(svg.find("inf\""), std::string::npos) << options.curve;
      EXPECT_LT(svg.size(), 3000000u) << options.curve;
      ++plotted;
    } catch (const Error&) {
    }
  }
  EXPECT_GT(plotted, 100);
}

} // namespace
} // namespace domewarp
