// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/mesh/weld.h"
#include "domewarp/refine/edge_oracle.h"
#include "domewarp/profile/half_angle.h"
#include "shapes.h"

namespace domewarp {
namespace {

std::string name(const Case& c) {
  return (c.surface.lens ? "lens" : c.surface.curve) + (c.projection == Projection::perspective ? " perspective" : " orthographic");
}

/// Interpolation error of the edge at t, image units.
double true_error(const EdgeOracle& oracle, const MappedPoint& a, const MappedPoint& b, double t) {
  return oracle.interior_error(a, b, a, {0.5 * (1 - t), t, 0.5 * (1 - t)});
}

/// Random trials per surface: DOMEWARP_TRIALS for the full count of 10^6.
int trials(int quick) {
  const char* wanted = std::getenv("DOMEWARP_TRIALS");
  return wanted ? std::atoi(wanted) : quick;
}

TEST(ErrorBound, CoversTheSampledErrorOfRandomEdges) {
  std::mt19937 random(20011);
  std::normal_distribution<double> normal;
  for (const Case& c : cases()) {
    const Surface surface(c.surface, std::sqrt(2.0));
    const ImageMap map = make_image_map(surface, Method::automatic);
    const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), {1e-4, 1e-4, 1, c.projection});
    int tested = 0, violations = 0;
    for (int i = 0; i < trials(40000); ++i) {
      const Vec3 p(normal(random), normal(random), normal(random));
      const Vec3 q = p + std::pow(10.0, -3.0 * (i % 100) / 100) * Vec3(normal(random), normal(random), normal(random));
      const bool in_order = precedes(p, q);
      const MappedPoint a = oracle.locate(in_order ? p : q), b = oracle.locate(in_order ? q : p);
      bool inside = true;
      for (int s = 0; s <= 32; ++s)
        for (const std::int8_t side : oracle.locate(point_at(a.eye, b.eye, s / 32.0)).sides) inside = inside && side > 0;
      if (!inside) continue;
      ++tested;
      const double bound = oracle.diagonal(a, b).error;
      for (int s = 1; s < 32; ++s) violations += true_error(oracle, a, b, s / 32.0) > bound * (1 + 1e-9) + 1e-12;
    }
    EXPECT_GT(tested, 1000) << name(c);
    EXPECT_EQ(violations, 0) << name(c);
  }
}

/// Triangles that are hard on a bound, about `at` and of about `size` times its distance; kind counts upwards.
std::array<Vec3, 3> adversarial_face(std::mt19937& random, int kind, double size) {
  std::normal_distribution<double> normal;
  const auto any = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  const Vec3 at = any();
  const double length = size * glm::length(at);
  const Vec3 along = glm::normalize(any()), across = glm::normalize(any());
  switch (kind % 6) {
    case 0: return {at, at + length * along, at + length * across};
    case 1: return {at, at + length * along, at + length * (0.5 * along + 1e-5 * across)};                    // sliver
    case 2: return {at, at + length * along, at + length * (0.3 * glm::normalize(at) + 0.4 * along)};         // seen nearly edge-on
    case 3: return {Vec3(-length, 0, -1), Vec3(length, 0, -1), Vec3(0, 0.1 * length * (1 + normal(random)), -1)}; // symmetric about the axis
    case 4: return {at, at * (1 + 3 * size), at * (1 + size) + length * across};                              // along the ray of sight
    default: {                                                                                                // around the axis
      const double z = at.z > 0 ? 1 : -1;
      return {Vec3(length, 0, z), Vec3(-0.5 * length, 0.9 * length, z), Vec3(-0.4 * length, -0.8 * length, z)};
    }
  }
}

/// A face of which everything is settled, so that the refinement would keep it unless its bound says no.
struct SettledFace {
  std::array<MappedPoint, 3> corner;
  std::array<SideBound, 3> side;
};

std::optional<SettledFace> settle(const EdgeOracle& oracle, const std::array<Vec3, 3>& eye) {
  SettledFace face;
  for (int k = 0; k < 3; ++k) {
    face.corner[k] = oracle.locate(eye[k]);
    for (const std::int8_t side : face.corner[k].sides)
      if (side < 0) return std::nullopt;
  }
  for (int k = 0; k < 3; ++k) {
    const MappedPoint &a = face.corner[k], &b = face.corner[(k + 1) % 3];
    const bool in_order = precedes(a.eye, b.eye);
    const EdgeDecision decision = oracle.decide(in_order ? a : b, in_order ? b : a);
    if (decision.split || !decision.certified) return std::nullopt;
    face.side[k] = {decision.middle, decision.arch, decision.depth_error};
  }
  return face;
}

/// The largest error of 91 points of the face, of its image or its depth, over the tolerance.
double sampled_face_error(const EdgeOracle& oracle, const SettledFace& face, bool of_depth) {
  constexpr int parts = 12;
  const auto& [a, b, c] = face.corner;
  double worst = 0;
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j) {
      const Vec3 weights = Vec3(i, j, parts - i - j) / double(parts);
      worst = std::max(worst, of_depth ? oracle.interior_depth_error(a, b, c, weights) : oracle.interior_error(a, b, c, weights));
    }
  return worst / (of_depth ? oracle.options().face_depth_tolerance : oracle.options().face_tolerance);
}

struct FaceTrial {
  int tested = 0, violations = 0;
  double worst = 0; ///< true error over tolerance
};

enum class Judged { image, depth };

/// Shrinks every triangle until it is just accepted, where a bound that is too small shows.
FaceTrial try_faces(const EdgeOracle& oracle, int count, bool ask_face, Judged judged = Judged::image) {
  std::mt19937 random(20012);
  FaceTrial trial;
  for (int i = 0; i < count; ++i) {
    const std::mt19937 same = random;
    for (double size = 1.2; size > 1e-5; size *= 0.7) {
      random = same;
      const std::array<Vec3, 3> eye = adversarial_face(random, i, size);
      const std::optional<SettledFace> face = settle(oracle, eye);
      if (!face) continue;
      FaceJudgement judgement;
      const auto& [a, b, c] = face->corner;
      if (ask_face && !oracle.is_good({&a, &b, &c}, face->side, 2, judgement)) continue;
      // A plane that the rim or the axis beyond it pierces is cut elsewhere (clipping), so only faces all inside count.
      bool inside = true;
      for (int s = 0; s < 66; ++s) {
        const double u = (s % 11) / 10.0, v = (1 - u) * (s / 11) / 5.0;
        for (const std::int8_t side : oracle.locate(eye[0] * u + eye[1] * v + eye[2] * (1 - u - v)).sides) inside = inside && side >= 0;
      }
      if (!inside) continue;
      const double error = sampled_face_error(oracle, *face, judged == Judged::depth);
      ++trial.tested;
      trial.violations += error > 1 + 1e-6;
      if (ask_face && judged == Judged::depth) trial.violations += error * oracle.options().face_depth_tolerance > judgement.depth_error * (1 + 1e-9) + 1e-12;
      trial.worst = std::max(trial.worst, error);
      break;
    }
  }
  return trial;
}

TEST(FaceBound, CoversTheSampledErrorOfAdversarialFaces) {
  for (const Case& c : cases()) {
    const Surface surface(c.surface, std::sqrt(2.0));
    const ImageMap map = make_image_map(surface, Method::automatic);
    const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), {1e-3, 1.03e-3, 1, c.projection});
    const FaceTrial trial = try_faces(oracle, trials(10'000), true);
    EXPECT_GT(trial.tested, trials(10'000) / 4) << name(c);
    EXPECT_EQ(trial.violations, 0) << name(c) << ": worst is " << trial.worst << " of the tolerance";
    EXPECT_GT(trial.worst, 0.5) << name(c) << ": these faces try nothing";
    std::printf("%s: %d faces, worst %.3f of the tolerance\n", name(c).c_str(), trial.tested, trial.worst);
  }
}

TEST(FaceBound, CoversTheSampledDepthOfAdversarialFaces) {
  for (const Case& c : cases()) {
    const Surface surface(c.surface, std::sqrt(2.0));
    const ImageMap map = make_image_map(surface, Method::automatic);
    const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), {1, 1.03, 2e-3, c.projection, 2e-3});
    const FaceTrial trial = try_faces(oracle, trials(10'000), true, Judged::depth);
    EXPECT_GT(trial.tested, trials(10'000) / 4) << name(c);
    EXPECT_EQ(trial.violations, 0) << name(c) << ": worst is " << trial.worst << " of the tolerance";
    EXPECT_GT(trial.worst, 0.5) << name(c) << ": these faces try nothing";
    std::printf("%s: %d faces, worst %.3f of the depth tolerance\n", name(c).c_str(), trial.tested, trial.worst);
  }
}

TEST(FaceBound, FacesWhoseSidesAloneAreGoodDoViolateTheDepthTolerance) {
  const Surface surface(curve("1-r^2"), std::sqrt(2.0));
  const ImageMap map = make_image_map(surface, Method::automatic);
  const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), {1, 1, 2e-3, Projection::orthographic, 2e-3});
  EXPECT_GT(try_faces(oracle, 10'000, false, Judged::depth).violations, 0);
}

/// Shrinks random edges until each is just kept; what was decided must cover 63 points of it.
TEST(EdgeOracle, TheErrorsOfWhatItKeepsCoverTheSampledOnes) {
  std::mt19937 random(20013);
  std::normal_distribution<double> normal;
  for (const Case& c : cases()) {
    const Surface surface(c.surface, std::sqrt(2.0));
    const ImageMap map = make_image_map(surface, Method::automatic);
    for (const OracleOptions& options : {OracleOptions{1e-3, 1e-3, 1, c.projection}, OracleOptions{1, 1, 2e-3, c.projection}}) {
      const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), options);
      int tested = 0, image = 0, arch = 0, depth = 0;
      for (int i = 0; i < trials(10'000); ++i) {
        const Vec3 p(normal(random), normal(random), normal(random)), along(normal(random), normal(random), normal(random));
        for (double size = 2; size > 1e-5; size *= 0.7) {
          const MappedPoint from = oracle.locate(p), to = oracle.locate(p + size * along);
          bool inside = true;
          for (int s = 0; s <= 32; ++s)
            for (const std::int8_t side : oracle.locate(point_at(from.eye, to.eye, s / 32.0)).sides) inside = inside && side > 0;
          if (!inside) continue;
          const bool in_order = precedes(from.eye, to.eye);
          const MappedPoint &a = in_order ? from : to, &b = in_order ? to : from;
          const EdgeDecision decision = oracle.decide(a, b);
          if (decision.split || !decision.certified) continue;
          ++tested;
          for (int s = 1; s < 64; ++s) {
            const double t = s / 64.0, error = true_error(oracle, a, b, t), rounding = 1e-12;
            image += error > decision.error * (1 + 1e-9) + rounding || error > options.tolerance * (1 + 1e-9) + rounding;
            arch += error > 4 * t * (1 - t) * decision.arch * (1 + 1e-9) + rounding;
            depth += oracle.interior_depth_error(a, b, a, {0.5 * (1 - t), t, 0.5 * (1 - t)}) > decision.depth_error * (1 + 1e-9) + rounding;
          }
          break;
        }
      }
      EXPECT_GT(tested, trials(10'000) / 10) << name(c);
      EXPECT_EQ(image, 0) << name(c);
      EXPECT_EQ(arch, 0) << name(c);
      EXPECT_EQ(depth, 0) << name(c);
    }
  }
}

TEST(FaceBound, FacesWhoseSidesAloneAreGoodDoViolateTheTolerance) {
  const Surface surface(curve("1-r^2"), std::sqrt(2.0));
  const ImageMap map = make_image_map(surface, Method::automatic);
  const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), {1e-3, 1e-3, 1, Projection::orthographic});
  EXPECT_GT(try_faces(oracle, 10'000, false).violations, 0);
}

TEST(RadialRanges, ContainWhatTheyBound) {
  SurfaceOptions projected = curve("1-r^2"), lens_projected = lens(Lens::equisolid, 180), measured;
  projected.projector = lens_projected.projector = 2;
  measured.profile = {{0, 1}, {0.3, 0.95}, {0.7, 0.6}, {1.2, -0.2}};
  for (const SurfaceOptions& options : {curve("1-r^2"), curve("sqrt(1-r^2)"), curve("1-r"), curve("1-0.3*abs(r-0.5)"), projected, lens_projected,
                                        measured, lens(Lens::equidistant, 360), lens(Lens::stereographic, 200)}) {
    const Surface surface(options, std::sqrt(2.0));
    const Branch branch = surface.branches()[0];
    const double high = highest_angle(branch);
    const RadialRanges ranges(surface, 0, branch.theta_low, high);
    for (int i = 1; i < 5000; ++i) {
      const double theta = branch.theta_low + (high - branch.theta_low) * (i + 0.3) / 5001, s = std::sin(theta), c = std::cos(theta);
      const double u = half_angle_index(s, c, 1);
      const RadialJet jet = surface.radial(0, theta);
      const RadialRange r = ranges.over(u, u);
      const auto expect = [&](const Range& range, double value, const char* what) {
        const double rounding = 1e-5 * (1 + std::abs(value));
        EXPECT_TRUE(value >= range.low - rounding && value <= range.high + rounding)
            << what << " " << value << " not in [" << range.low << ", " << range.high << "] at " << theta << " of " << options.curve;
      };
      expect(r.slope, jet.dr, "R'");
      expect(r.along, jet.d2r, "R''");
      expect(r.across, (jet.dr * s * c - jet.r) / (s * s), "B");
      expect(r.twist, (jet.dr * s - jet.r * c) / (s * s), "C");
      expect(r.factor, jet.r / s, "K");
    }
  }
}

TEST(RadialRanges, KnowTheForwardAxis) {
  // The index of the axis is a difference of rounded numbers: it must not fall into the margin before it.
  for (const double fov : {180.0, 205.0, 260.0, 265.0, 275.0}) {
    const Surface surface(lens(Lens::equidistant, fov), std::sqrt(2.0));
    EXPECT_TRUE(std::isfinite(RadialRanges(surface, 0, 0, surface.branches()[0].theta_high).over(0, 0).along.high)) << fov;
  }
  const Surface wide(curve("1-r^2"), std::hypot(16.0 / 9, 1));
  EXPECT_TRUE(std::isfinite(RadialRanges(wide, 0, 0, wide.branches()[0].theta_high).over(0, 0).along.high));
}

TEST(ErrorBound, CoversTheDepthAcrossAnExtendedRim) {
  // The weight stays beyond r_max, and so has a kink there.
  SurfaceOptions options = curve("1-r");
  options.rmax = 0.7;
  options.extension_deg = 10;
  const Surface surface(options, std::sqrt(2.0));
  const BranchMap map(surface, 0, Method::direct);
  const ErrorBound bound(surface, 0, map.branch().theta_low, highest_angle(map.branch()), Projection::perspective);
  const double rim = surface.branches()[0].theta_high;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto at = [&](double theta, double phi, double rho) {
      return direction_of(rho * Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta)));
    };
    const Direction a = at(rim - 0.05 * std::abs(uniform(random)), 0.05 * uniform(random), 1), b = at(rim + 0.05 * std::abs(uniform(random)), 0, 1 + 0.3 * uniform(random));
    const double wa = a.rho * map.factors(a.eye).g, wb = b.rho * map.factors(b.eye).g, bounded = bound.edge(a, b, wa, wb).depth;
    for (int s = 1; s < 32; ++s) {
      const double t = s / 32.0;
      const Vec3 eye = a.eye * (1 - t) + b.eye * t;
      const double off = std::abs((wa * (1 - t) + wb * t) / (glm::length(eye) * map.factors(eye).g) - 1);
      worst = std::max(worst, off);
      EXPECT_LE(off, bounded * (1 + 1e-9) + 1e-12);
    }
  }
  EXPECT_GT(worst, 0.002); // it would matter
}

TEST(ErrorBound, IsNoTriviallyLargeNumber) {
  const Surface surface(curve("1-r^2"), std::sqrt(2.0));
  const ImageMap map = make_image_map(surface, Method::automatic);
  const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), {1e-4, 1e-4, 1, Projection::orthographic});
  const MappedPoint a = oracle.locate({0.5, 0.3, -1}), b = oracle.locate({0.55, 0.35, -1});
  EXPECT_LT(oracle.diagonal(a, b).error, 3 * true_error(oracle, a, b, 0.5));
}

TEST(EdgeOracle, SplitsTheEdgeWhoseMidpointErrorVanishes) {
  // Symmetric about the axis: right at its midpoint, 93 px wrong at its quarters on a 4096-row dome master.
  const Surface surface(lens(Lens::equidistant, 180), std::sqrt(2.0));
  const ImageMap map = make_image_map(surface, Method::automatic);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const EdgeOracle oracle(surface, 0, map.branches[0], make_visible_region(map.branches[0].branch(), 1e-9), {0.5 * 2 / 4096, 0.5 * 2 / 4096, 1, projection});
    const MappedPoint a = oracle.locate({0, -1, -1.7}), b = oracle.locate({0, 1, -1.7}); // below 60 degrees: judged by error
    EXPECT_LT(true_error(oracle, a, b, 0.5), 1e-12);
    EXPECT_TRUE(oracle.decide(a, b).split.has_value());
  }
}

} // namespace
} // namespace domewarp
