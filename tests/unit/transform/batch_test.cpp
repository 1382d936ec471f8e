// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "domewarp/core/parallel.h"
#include "domewarp/transform/batch.h"
#include "surfaces.h"

namespace domewarp {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double blind_radius = 1e4;

// x y z x y z ...
using Cloud = std::vector<float>;

Cloud random_directions(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<float> normal;
  Cloud cloud(3 * count);
  for (float& value : cloud) value = normal(random);
  return cloud;
}

Vec3 point(const Cloud& cloud, std::size_t i) { return {cloud[3 * i], cloud[3 * i + 1], cloud[3 * i + 2]}; }

Cloud map(const BatchMap& batch, const Cloud& in, BatchOutput output = BatchOutput::image) {
  Cloud out(in.size());
  batch.map(interleaved(in.data()), interleaved(out.data()), in.size() / 3, output);
  return out;
}

Cloud map_split(const BatchMap& batch, const Cloud& in, BatchOutput output = BatchOutput::image) {
  const std::size_t count = in.size() / 3;
  Cloud split(in.size()), mapped(in.size()), out(in.size());
  for (std::size_t i = 0; i < in.size(); ++i) split[i % 3 * count + i / 3] = in[i];
  float* const p = mapped.data();
  batch.map({&split[0], &split[count], &split[2 * count], 1}, {p, p + count, p + 2 * count, 1}, count, output);
  for (std::size_t i = 0; i < in.size(); ++i) out[i] = mapped[i % 3 * count + i / 3];
  return out;
}

// Not a number counts as equal to itself.
bool same_bits(const Cloud& a, const Cloud& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](float x, float y) { return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y); });
}

// Of visible points, against the direct method in double precision.
double largest_error(const Surface& surface, const Cloud& in, const Cloud& out) {
  const ImageMap exact = make_image_map(surface, Method::direct);
  double worst = 0;
  for (std::size_t i = 0; i < in.size() / 3; ++i) {
    const ImagePoint q = project(surface, exact, point(in, i));
    if (q.state != PointState::visible) continue;
    const double error = std::hypot(q.x - out[3 * i], q.y - out[3 * i + 1]);
    worst = error <= worst ? worst : error; // keeps a nan
  }
  return worst;
}

std::vector<Surface> table_surfaces() {
  std::vector<Surface> surfaces;
  for (const Surface& surface : many_surfaces())
    if (BatchMap(surface).report().vectorised) surfaces.push_back(surface);
  return surfaces;
}

class Batch : public testing::Test {
protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_F(Batch, ThesisCurvesAreExactToAMillionth) {
  const std::size_t count = 50000;
  std::vector<ReferenceCurve> curves = reference_curves();
  curves.push_back(fisheye_curve());
  for (const double r_max : {1.0, corner_radius})
    for (const ReferenceCurve& curve : curves) {
      const Surface surface = curve_surface(curve.text, std::nullopt, r_max);
      if (surface.branches().size() > 1) continue;
      const BatchMap batch(surface);
      EXPECT_TRUE(batch.report().vectorised) << describe(surface);
      const Cloud in = random_directions(count, 1);
      const double error = largest_error(surface, in, map(batch, in));
      EXPECT_LT(error, 1e-6) << describe(surface);
      EXPECT_LT(error, batch.report().predicted_error) << describe(surface);
    }
}

TEST_F(Batch, EverySurfaceIsWithinWhatWasPredicted) {
  for (const Surface& surface : table_surfaces()) {
    const BatchMap batch(surface);
    const Cloud in = random_directions(5000, 2);
    EXPECT_LT(largest_error(surface, in, map(batch, in)), 1.5 * batch.report().predicted_error) << describe(surface);
    EXPECT_LE(batch.report().predicted_error, 5e-6);
  }
}

TEST_F(Batch, AClosedFormAgrees) {
  const Surface dome = lens_surface(Lens::equidistant, 300);
  const BatchMap batch(dome);
  ASSERT_TRUE(batch.report().vectorised);
  const Cloud in = random_directions(20000, 3), out = map(batch, in);
  for (std::size_t i = 0; i < in.size() / 3; ++i) {
    const long double x = in[3 * i], y = in[3 * i + 1], z = -in[3 * i + 2], r = std::hypot(x, y);
    const long double theta = std::atan2(r, z), radius = theta / (150 * std::numbers::pi_v<long double> / 180);
    if (radius > 1) continue;
    EXPECT_NEAR(out[3 * i], static_cast<double>(x / r * radius), 1e-6);
    EXPECT_NEAR(out[3 * i + 1], static_cast<double>(y / r * radius), 1e-6);
    EXPECT_NEAR(out[3 * i + 2], static_cast<double>(std::hypot(x, y, z)), 1e-6);
  }
}

TEST_F(Batch, ATableOfTheWrongCurveIsFarOff) {
  const Cloud in = random_directions(1000, 4);
  EXPECT_GT(largest_error(curve_surface("1-r^2"), in, map(BatchMap(curve_surface("1-1.001*r^2")), in)), 1e-5);
}

TEST_F(Batch, Avx2AndAvx512GiveTheSameBitsInEitherLayout) {
  if ((hwy::SupportedTargets() & HWY_AVX2) == 0) GTEST_SKIP() << "this CPU has no AVX2";
  const Cloud in = random_directions(5000, 5);
  for (const Surface& surface : table_surfaces()) {
    const BatchMap batch(surface);
    for (const BatchOutput output : {BatchOutput::image, BatchOutput::perspective}) {
      hwy::SetSupportedTargetsForTest(0);
      const Cloud widest = map(batch, in, output), split = map_split(batch, in, output);
      hwy::SetSupportedTargetsForTest(HWY_AVX2);
      EXPECT_TRUE(same_bits(widest, split)) << describe(surface);
      EXPECT_TRUE(same_bits(widest, map(batch, in, output))) << describe(surface);
      EXPECT_TRUE(same_bits(widest, map_split(batch, in, output))) << describe(surface);
    }
  }
}

TEST_F(Batch, OldProcessorsAreAsExact) {
  hwy::SetSupportedTargetsForTest(HWY_SSE4);
  for (const Surface& surface : table_surfaces()) {
    const BatchMap batch(surface);
    const Cloud in = random_directions(2000, 6), out = map(batch, in);
    EXPECT_LT(largest_error(surface, in, out), 1.5 * batch.report().predicted_error) << describe(surface);
    EXPECT_TRUE(same_bits(out, map_split(batch, in)));
  }
}

TEST_F(Batch, PointsMayComeInOneLayoutAndLeaveInTheOther) {
  const BatchMap batch(curve_surface("1-r^2"));
  for (const std::size_t count : {100, 5000}) {
    const Cloud in = random_directions(count, 11);
    Cloud split(in.size()), mapped(in.size()), out(in.size());
    for (std::size_t i = 0; i < in.size(); ++i) split[i % 3 * count + i / 3] = in[i];
    batch.map({&split[0], &split[count], &split[2 * count], 1}, interleaved(out.data()), count, BatchOutput::image);
    EXPECT_TRUE(same_bits(out, map(batch, in)));
    float* const p = mapped.data();
    batch.map(interleaved(in.data()), {p, p + count, p + 2 * count, 1}, count, BatchOutput::image);
    for (std::size_t i = 0; i < in.size(); ++i) out[i] = mapped[i % 3 * count + i / 3];
    EXPECT_TRUE(same_bits(out, map(batch, in)));
  }
}

TEST_F(Batch, ThreadsPlacesAndStreamingDoNotMatter) {
  const BatchMap batch(curve_surface("1-r^2"));
  Cloud in = random_directions((2 << 20) + 77, 7); // more than the caches hold, and no whole number of blocks
  in[30001] = std::numeric_limits<float>::denorm_min();
  const Cloud all = map(batch, in);
  {
    const ThreadLimit one(1);
    EXPECT_TRUE(same_bits(all, map(batch, in)));
  }
  EXPECT_TRUE(same_bits(all, map_split(batch, in)));
  for (const std::size_t count : {0, 1, 15, 1023, 1024, 1025, 2000}) {
    const Cloud part(in.begin() + 30000, in.begin() + 30000 + 3 * static_cast<std::ptrdiff_t>(count));
    EXPECT_TRUE(same_bits(map(batch, part), {all.begin() + 30000, all.begin() + 30000 + 3 * static_cast<std::ptrdiff_t>(count)})) << count;
  }
}

TEST_F(Batch, PerspectiveOutputIsTheImageTimesAPositiveWeight) {
  const Cloud in = random_directions(3000, 8);
  for (const Surface& surface : table_surfaces()) {
    const BatchMap batch(surface);
    const ImageMap exact = make_image_map(surface, Method::direct);
    const Cloud image = map(batch, in), warped = map(batch, in, BatchOutput::perspective);
    for (std::size_t i = 0; i < in.size() / 3; ++i) {
      const double w = -warped[3 * i + 2];
      ASSERT_GT(w, 0) << describe(surface);
      EXPECT_NEAR(warped[3 * i] / w, image[3 * i], 2e-7 * (1 + std::abs(image[3 * i])));
      EXPECT_NEAR(warped[3 * i + 1] / w, image[3 * i + 1], 2e-7 * (1 + std::abs(image[3 * i + 1])));
      if (project(surface, exact, point(in, i)).state != PointState::visible) continue;
      const double g = exact.branches.front().factors(point(in, i)).g, rho = image[3 * i + 2];
      EXPECT_NEAR(w / (rho * g), 1, 3e-3) << describe(surface);
    }
  }
}

// Directions where things change, at every length that float has.
Cloud adversarial_points(const Surface& surface, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> angles{0, pi / 2, pi, surface.blind().theta_low};
  for (const Branch& branch : surface.branches()) {
    const std::vector<double> more = branch_angles(branch, random, 50);
    angles.insert(angles.end(), more.begin(), more.end());
  }
  Cloud cloud;
  for (const double angle : angles)
    for (const double side : {-1e-3, -1e-6, 0.0, 1e-6, 1e-3})
      for (const double length : {1e-44, 1e-40, 1e-37, 1e-30, 1e-19, 1e-15, 1e-6, 1.0, 1e6, 1e15, 1e19, 1e30, 1e38}) {
        const Vec3 p = length * towards(std::clamp(angle + side, 0.0, pi), 7 * uniform(random));
        cloud.insert(cloud.end(), {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
      }
  return cloud;
}

// Where float rounds the point itself decides the side of an edge; points nearer to one than that prove nothing.
bool is_clear(const Surface& surface, const ImageMap& exact, const Vec3& p, PointState state) {
  const double theta = std::atan2(std::hypot(p.x, p.y), -p.z), phi = std::atan2(p.y, p.x);
  for (const double side : {-3e-6, 3e-6})
    if (project(surface, exact, towards(std::clamp(theta + side, 0.0, pi), phi)).state != state) return false;
  return true;
}

TEST_F(Batch, NoLengthAndNoDirectionMisleadsIt) {
  for (const Surface& surface : table_surfaces()) {
    const BatchMap batch(surface);
    const ImageMap exact = make_image_map(surface, Method::direct);
    const Cloud in = adversarial_points(surface, 9), out = map(batch, in);
    for (std::size_t i = 0; i < in.size() / 3; ++i) {
      const Vec3 p = point(in, i);
      if (p == Vec3(0)) continue;
      const ImagePoint q = project(surface, exact, p);
      const double x = out[3 * i], y = out[3 * i + 1], radius = std::hypot(x, y);
      ASSERT_TRUE(std::isfinite(x) && std::isfinite(y)) << describe(surface) << " " << p.x << " " << p.y << " " << p.z;
      EXPECT_NEAR(out[3 * i + 2] / static_cast<float>(q.depth), 1, q.depth < 1e-37 ? 1 : 1e-6);
      EXPECT_LE(radius, blind_radius * 1.00001);
      if (!is_clear(surface, exact, p, q.state)) continue;
      const double limit = 1.5 * batch.report().predicted_error;
      if (q.state == PointState::blind) {
        EXPECT_GT(radius, 0.999 * blind_radius) << describe(surface);
      }
      if (q.state == PointState::visible) {
        EXPECT_LE(std::hypot(q.x - x, q.y - y), limit) << describe(surface) << " " << p.x << " " << p.y << " " << p.z;
        EXPECT_LE(radius, surface.r_max() + limit);
      }
      if (q.state == PointState::extended) {
        EXPECT_GE(radius, surface.r_max() - limit) << describe(surface);
      }
    }
  }
}

TEST_F(Batch, WhatHasNoDirectionHasNoImage) {
  constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const BatchMap batch(curve_surface("1-r^2"));
  const Cloud in{0, 0, 0, infinity, 0, -1, 0, nan, -1, 0, 0, -infinity, 1, 1, -1};
  const Cloud out = map(batch, in);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_TRUE(std::isnan(out[i])) << i;
  for (std::size_t i = 12; i < 15; ++i) EXPECT_TRUE(std::isfinite(out[i])) << i;
}

TEST_F(Batch, SurfacesWithoutATableAreMappedOneByOne) {
  const Surface doubled = curve_surface("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1");
  const BatchMap batch(doubled);
  EXPECT_FALSE(batch.report().vectorised || batch.report().direct);
  const Cloud in = random_directions(2000, 10);
  EXPECT_LT(largest_error(doubled, in, map(batch, in)), 2e-7);
  BatchOptions options;
  options.max_error = 1e-7; // finer than single precision
  EXPECT_FALSE(BatchMap(curve_surface("1-r^2"), options).report().vectorised);
  options = {};
  options.points = float_table_pays_from - 1;
  const BatchReport few = BatchMap(curve_surface("1-r^2"), options).report();
  EXPECT_TRUE(!few.vectorised && few.direct && few.reason == TableReason::few_points);
  options.points = float_table_pays_from;
  EXPECT_TRUE(BatchMap(curve_surface("1-r^2"), options).report().vectorised);
}

TEST_F(Batch, AWholeDomeAndAKinkGetATable) {
  for (const Surface& surface : {lens_surface(Lens::equidistant, 360), lens_surface(Lens::equidistant, 180), curve_surface("1-abs(r-.37)")})
    EXPECT_TRUE(BatchMap(surface).report().vectorised) << describe(surface);
}

} // namespace
} // namespace domewarp
