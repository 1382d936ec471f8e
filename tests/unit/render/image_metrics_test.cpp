// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/image_metrics.h"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace domewarp {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

Pixels plain(int width, int height, const Rgb& colour) {
  Pixels pixels{width, height, {}};
  for (int i = 0; i < width * height; ++i) pixels.rgba.insert(pixels.rgba.end(), {colour[0], colour[1], colour[2], 255});
  return pixels;
}

Pixels noise(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Pixels pixels = plain(width, height, {0, 0, 0});
  for (std::size_t i = 0; i < pixels.rgba.size(); ++i)
    if (i % 4 != 3) pixels.rgba[i] = static_cast<std::uint8_t>(random() % 256);
  return pixels;
}

TEST(Psnr, FollowsItsDefinition) {
  EXPECT_FALSE(psnr_db(plain(20, 20, {9, 9, 9}), plain(20, 20, {9, 9, 9})));
  EXPECT_NEAR(*psnr_db(plain(20, 20, {10, 10, 10}), plain(20, 20, {11, 11, 11})), 20 * std::log10(255.0), 1e-9);
}

TEST(Ssim, FollowsItsDefinitionForPlainPictures) {
  const double c1 = 2.55 * 2.55;
  EXPECT_NEAR(*structural_similarity(plain(30, 20, {50, 50, 50}), plain(30, 20, {90, 90, 90})),
              (2 * 50 * 90 + c1) / (50 * 50 + 90 * 90 + c1), 1e-9);
  EXPECT_FALSE(structural_similarity(plain(10, 30, {0, 0, 0}), plain(10, 30, {0, 0, 0})));
}

/// The definition, window by window.
double slow_ssim(const Pixels& a, const Pixels& b) {
  const auto luma = [](const Pixels& p, int x, int y) {
    const std::uint8_t* c = &p.rgba[4 * std::size_t(y * p.width + x)];
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
  };
  double total = 0;
  int windows = 0;
  for (int y = 5; y < a.height - 5; ++y)
    for (int x = 5; x < a.width - 5; ++x, ++windows) {
      double sum = 0, ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
      for (int pass = 0; pass < 3; ++pass) // weights, means, deviations
        for (int v = -5; v <= 5; ++v)
          for (int u = -5; u <= 5; ++u) {
            const double w = std::exp(-(u * u + v * v) / (2 * 1.5 * 1.5)) / (pass ? sum : 1);
            const double p = luma(a, x + u, y + v), q = luma(b, x + u, y + v);
            if (pass == 0) sum += w;
            if (pass == 1) ma += w * p, mb += w * q;
            if (pass == 2) va += w * (p - ma) * (p - ma), vb += w * (q - mb) * (q - mb), cov += w * (p - ma) * (q - mb);
          }
      const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
      total += (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
    }
  return total / windows;
}

TEST(Ssim, AgreesWithASlowCopyOfTheDefinition) {
  const Pixels a = noise(41, 90, 1);
  Pixels b = a;
  for (std::size_t i = 0; i < b.rgba.size(); i += 3)
    if (i % 4 != 3) b.rgba[i] = static_cast<std::uint8_t>(b.rgba[i] / 2 + 40);
  EXPECT_NEAR(*structural_similarity(a, b), slow_ssim(a, b), 1e-9);
  EXPECT_LT(*structural_similarity(a, b), 0.99);
}

TEST(Flip, IsZeroForEqualAndOneForTheMostDifferentPlainPictures) {
  const Pixels a = noise(50, 70, 2);
  EXPECT_EQ(flip(a, a).max, 0);
  const FlipReport most = flip(plain(40, 30, {0, 255, 0}), plain(40, 30, {0, 0, 255}));
  EXPECT_NEAR(most.mean, 1, 1e-4) << "green and blue are the ends of its scale";
  EXPECT_NEAR(most.max, 1, 1e-4);
}

TEST(Flip, OfBlackAndWhiteFollowsFromItsScale) {
  // HyAB 100 and 203.4 for black-white and green-blue: 0.95 + 0.05 (100^0.7 - 0.4 c) / (0.6 c), c = 203.4^0.7.
  EXPECT_NEAR(flip(plain(40, 30, {0, 0, 0}), plain(40, 30, {255, 255, 255})).mean, 0.967, 0.001);
}

TEST(Flip, SeesNearbyPixelsBetterThanFarOnes) {
  const Pixels a = plain(60, 60, {120, 120, 120});
  Pixels b = a;
  for (int k = 0; k < 3; ++k) b.rgba[4 * (30 * 60 + 30) + std::size_t(k)] = 255;
  const double close = flip(a, b, 20).max, usual = flip(a, b).max, far = flip(a, b, 300).max;
  EXPECT_GT(close, usual);
  EXPECT_GT(usual, far);
  EXPECT_GT(far, 0);
}

TEST(Flip, DoesNotDependOnWhereStripsEnd) {
  // The same difference at two heights of a plain picture, one across the border of two strips.
  const Pixels a = plain(64, 200, {90, 60, 30});
  const auto with_line = [&](int row) {
    Pixels b = a;
    for (int x = 0; x < 64; ++x) b.rgba[4 * std::size_t(row * 64 + x)] = 255;
    return flip(a, b);
  };
  EXPECT_NEAR(with_line(63).mean, with_line(100).mean, 1e-6);
  EXPECT_NEAR(with_line(64).max, with_line(95).max, 1e-6);
}

} // namespace
} // namespace domewarp
