// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "domewarp/core/errors.h"
#include "domewarp/render/compare.h"

namespace domewarp {

namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr Colour black = {0, 0, 0}, white = {255, 255, 255}, magenta = {255, 0, 255};

Pixels blank(int width, int height) {
  Pixels pixels{width, height, std::vector<std::uint8_t>(4 * std::size_t(width) * std::size_t(height), 255)};
  return pixels;
}

void paint(Pixels& pixels, std::size_t pixel, const Colour& colour) {
  std::copy(colour.begin(), colour.end(), &pixels.rgba[4 * pixel]);
}

void paint(Pixels& pixels, int x, int y, const Colour& colour) {
  if (x < 0 || y < 0 || x >= pixels.width || y >= pixels.height) return;
  paint(pixels, std::size_t(y) * std::size_t(pixels.width) + std::size_t(x), colour);
}

/// Dark blue, blue, green, yellow, red for 0 .. 1.
Colour heat(double value) {
  constexpr std::array<std::array<double, 3>, 5> stops = {
      {{16, 16, 72}, {32, 112, 208}, {40, 184, 104}, {248, 216, 48}, {216, 24, 24}}};
  const double at = std::clamp(value, 0.0, 1.0) * (stops.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  Colour colour{};
  for (std::size_t k = 0; k < 3; ++k)
    colour[k] = static_cast<std::uint8_t>(std::lround(std::lerp(stops[i][k], stops[i + 1][k], at - double(i))));
  return colour;
}

Colour verdict_colour(const CompareReport& report, std::size_t i, double full_scale_px) {
  switch (report.verdicts[i]) {
  case Verdict::background:
    return black;
  case Verdict::pinhole:
    return magenta;
  case Verdict::mismatch:
    return white;
  case Verdict::reference_only:
    return {96, 96, 96};
  case Verdict::same:
  case Verdict::warped_only:
    break;
  }
  const double value = report.displacement[i];
  return std::isnan(value) ? Colour{160, 160, 160} : heat(value / full_scale_px);
}

/// 3 x 5 letters, a bit per dot, rows from the top, leftmost dot highest.
std::array<int, 5> glyph(char letter) {
  constexpr std::array<std::array<int, 5>, 10> digits = {{{7, 5, 5, 5, 7},
                                                          {2, 6, 2, 2, 7},
                                                          {7, 1, 7, 4, 7},
                                                          {7, 1, 7, 1, 7},
                                                          {5, 5, 7, 1, 1},
                                                          {7, 4, 7, 1, 7},
                                                          {7, 4, 7, 5, 7},
                                                          {7, 1, 1, 2, 2},
                                                          {7, 5, 7, 5, 7},
                                                          {7, 5, 7, 1, 7}}};
  if (letter >= '0' && letter <= '9') return digits[std::size_t(letter - '0')];
  switch (letter) {
  case '.':
    return {0, 0, 0, 0, 2};
  case 'p':
    return {0, 6, 5, 6, 4};
  case 'x':
    return {0, 5, 2, 5, 0};
  default:
    return {0, 0, 0, 0, 0};
  }
}

void write_text(Pixels& pixels, int left, int top, int dot, std::string_view text) {
  for (const char letter : text) {
    const std::array<int, 5> rows = glyph(letter);
    for (int y = 0; y < 5 * dot; ++y)
      for (int x = 0; x < 3 * dot; ++x)
        if (rows[std::size_t(y / dot)] >> (2 - x / dot) & 1) paint(pixels, left + x, top + y, white);
    left += 4 * dot;
  }
}

/// A bar of all colours with five ticks and their values in pixels.
void draw_scale(Pixels& pixels, int top, int dot, double full_scale_px) {
  const int height = pixels.height - top;
  const int left = 2 * dot, right = pixels.width - 2 * dot, bar = top + dot, text = top + height / 2;
  for (int y = top; y < pixels.height; ++y)
    for (int x = 0; x < pixels.width; ++x) {
      const bool in_bar = y >= bar && y < text - dot && x >= left && x < right;
      paint(pixels, x, y, in_bar ? heat(double(x - left) / std::max(right - left - 1, 1)) : black);
    }
  for (int tick = 0; tick <= 4; ++tick) {
    std::array<char, 32> label{};
    std::snprintf(label.data(), label.size(), tick == 4 ? "%.3g px" : "%.3g", full_scale_px * tick / 4);
    const int width = static_cast<int>(std::string_view(label.data()).size()) * 4 * dot - dot;
    const int centre = left + (right - left) * tick / 4;
    write_text(pixels, std::clamp(centre - width / 2, left, std::max(right - width, left)), text, dot, label.data());
  }
}

} // namespace

Pixels displacement_picture(const CompareReport& report, const Raster& raster, double full_scale_px) {
  if (!(full_scale_px > 0) || report.verdicts.size() != std::size_t(raster.width) * std::size_t(raster.height))
    throw Error(ErrorCode::usage,
                "compare: a displacement picture needs a positive scale and the raster of its report");
  const int dot = std::max(1, raster.width / 256);
  Pixels pixels = blank(raster.width, raster.height + 16 * dot);
  for (std::size_t i = 0; i < report.verdicts.size(); ++i) paint(pixels, i, verdict_colour(report, i, full_scale_px));
  draw_scale(pixels, raster.height, dot, full_scale_px);
  return pixels;
}

Pixels difference_picture(const Frame& reference, const Frame& warped) {
  if (reference.width != warped.width || reference.height != warped.height)
    throw Error(ErrorCode::usage, "compare: a difference picture needs two pictures of one size");
  Pixels pixels = blank(reference.width, reference.height);
  for (std::size_t i = 0; i < reference.object.size(); ++i) {
    Colour colour = magenta;
    if ((reference.object[i] != 0) == (warped.object[i] != 0))
      for (std::size_t k = 0; k < 3; ++k) {
        const int difference = std::abs(int(reference.rgba[4 * i + k]) - int(warped.rgba[4 * i + k]));
        colour[k] = static_cast<std::uint8_t>(std::min(4 * difference, 255));
      }
    paint(pixels, i, colour);
  }
  return pixels;
}

} // namespace domewarp
