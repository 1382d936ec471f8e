// SPDX-License-Identifier: Apache-2.0
// Based on: Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to Structural Similarity",
// IEEE Transactions on Image Processing 13(4), 2004.
#include "domewarp/render/image_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

constexpr int window = 11;
constexpr int strip = 64; ///< rows of windows that are worked on at once

using Weights = std::array<double, window>;

Weights gaussian(double sigma) {
  constexpr int half = window / 2;
  Weights weights{};
  for (int i = 0; i < window; ++i)
    weights[std::size_t(i)] = std::exp(-0.5 * (i - half) * (i - half) / (sigma * sigma));
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& w : weights) w /= sum;
  return weights;
}

double luma(const std::uint8_t* p) {
  return (0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]) * p[3] / 255.0;
}

/// Windowed means of two values, their squares and their product.
struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void add(double weight, const Moments& m) {
    a += weight * m.a;
    b += weight * m.b;
    aa += weight * m.aa;
    bb += weight * m.bb;
    ab += weight * m.ab;
  }
};

Moments moments_of(double a, double b) {
  return {a, b, a * a, b * b, a * b};
}

double similarity(const Moments& m) {
  constexpr double c1 = (0.01 * 255) * (0.01 * 255), c2 = (0.03 * 255) * (0.03 * 255);
  const double aa = m.aa - m.a * m.a, bb = m.bb - m.b * m.b, ab = m.ab - m.a * m.b;
  return (2 * m.a * m.b + c1) * (2 * ab + c2) / ((m.a * m.a + m.b * m.b + c1) * (aa + bb + c2));
}

/// The windows of one row of pixels, summed across.
void sum_row(const Pixels& a, const Pixels& b, int row, const Weights& weights, std::vector<Moments>& out) {
  const std::size_t first = 4 * std::size_t(row) * std::size_t(a.width);
  std::vector<Moments> pixels(static_cast<std::size_t>(a.width));
  for (std::size_t x = 0; x < pixels.size(); ++x)
    pixels[x] = moments_of(luma(&a.rgba[first + 4 * x]), luma(&b.rgba[first + 4 * x]));
  out.assign(pixels.size() - window + 1, {});
  for (std::size_t x = 0; x < out.size(); ++x)
    for (std::size_t k = 0; k < window; ++k) out[x].add(weights[k], pixels[x + k]);
}

/// Sum of the similarities of the windows whose first rows are [top, bottom).
double sum_strip(const Pixels& a, const Pixels& b, int top, int bottom, const Weights& weights) {
  std::vector<std::vector<Moments>> rows(std::size_t(bottom - top + window - 1));
  for (std::size_t i = 0; i < rows.size(); ++i) sum_row(a, b, top + static_cast<int>(i), weights, rows[i]);
  double sum = 0;
  for (std::size_t y = 0; y < std::size_t(bottom - top); ++y)
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      Moments m;
      for (std::size_t k = 0; k < window; ++k) m.add(weights[k], rows[y + k][x]);
      sum += similarity(m);
    }
  return sum;
}

} // namespace

std::optional<double> psnr_db(const Pixels& a, const Pixels& b) {
  const std::size_t pixels = std::size_t(a.width) * std::size_t(a.height);
  double squares = 0;
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t k = 4 * i; k < 4 * i + 3; ++k) {
      const double difference = (a.rgba[k] * a.rgba[4 * i + 3] - b.rgba[k] * b.rgba[4 * i + 3]) / 255.0;
      squares += difference * difference;
    }
  if (squares == 0) return std::nullopt;
  return 10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(pixels) / squares);
}

std::optional<double> structural_similarity(const Pixels& a, const Pixels& b) {
  const int across = a.width - window + 1, down = a.height - window + 1;
  if (across < 1 || down < 1) return std::nullopt;
  const Weights weights = gaussian(1.5);
  std::vector<double> sums(std::size_t((down + strip - 1) / strip));
  parallel_each(sums.size(), 1, [&](std::size_t i) {
    const int top = static_cast<int>(i) * strip;
    sums[i] = sum_strip(a, b, top, std::min(top + strip, down), weights);
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0) / (double(across) * down);
}

} // namespace domewarp
