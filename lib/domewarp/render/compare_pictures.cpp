// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/compare_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/render/canvas.h"

namespace domewarp {

namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr Colour black = {0, 0, 0}, white = {255, 255, 255}, magenta = {255, 0, 255}, yellow = {255, 230, 0};

void paint(Pixels& pixels, std::size_t pixel, const Colour& colour) {
  std::copy(colour.begin(), colour.end(), &pixels.rgba[4 * pixel]);
  pixels.rgba[4 * pixel + 3] = 255;
}

Pixels blank(int width, int height) {
  return {width, height, std::vector<std::uint8_t>(4 * std::size_t(width) * std::size_t(height), 255)};
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

bool is_pinhole(Verdict v) { return v == Verdict::pinhole || v == Verdict::seam_pinhole; }

bool is_mismatch(Verdict v) { return v == Verdict::mismatch || v == Verdict::seam_mismatch; }

Colour displacement_colour(const CompareReport& report, std::size_t i, double full_scale_px) {
  const Verdict verdict = report.verdicts[i];
  if (verdict == Verdict::background) return black;
  if (is_pinhole(verdict)) return magenta;
  if (is_mismatch(verdict)) return white;
  const double value = report.displacement[i];
  return std::isnan(value) ? Colour{128, 128, 128} : heat(value / full_scale_px);
}

/// A bar of all colours with five ticks and their values in pixels, in the canvas from `top` down.
void draw_scale(Canvas& canvas, int width, int top, double unit, double full_scale_px) {
  const double left = 2 * unit, right = width - 2 * unit, bar = top + 0.6 * unit, height = unit;
  const int steps = std::min(256, static_cast<int>(right - left));
  for (int i = 0; i < steps; ++i) {
    const Colour colour = heat(double(i) / std::max(steps - 1, 1));
    canvas.rectangle(left + (right - left) * i / steps, bar, (right - left) / steps + 1, height,
                     {colour[0], colour[1], colour[2]});
  }
  for (int tick = 0; tick <= 4; ++tick) {
    std::array<char, 32> label{};
    std::snprintf(label.data(), label.size(), tick == 4 ? "%.3g px" : "%.3g", full_scale_px * tick / 4);
    const Align align = tick == 0 ? Align::left : tick == 4 ? Align::right : Align::centre;
    canvas.text(left + (right - left) * tick / 4, bar + 2.2 * unit, unit, label.data(), {255, 255, 255}, align);
  }
}

/// Rings around the marked pixels, the first 200 of them.
template <typename Marked>
void draw_rings(Canvas& canvas, int width, std::size_t pixels, const Ink& ink, Marked&& marked) {
  constexpr std::size_t most = 200;
  const double radius = std::max(6.0, width / 100.0);
  std::size_t drawn = 0;
  for (std::size_t i = 0; i < pixels && drawn < most; ++i) {
    if (!marked(i)) continue;
    const std::size_t column = i % std::size_t(width), row = i / std::size_t(width);
    const Vec2 centre(double(column) + 0.5, double(row) + 0.5);
    canvas.ring(centre, radius, ink, std::max(1.0, radius / 8));
    ++drawn;
  }
}

double distance_to_edge(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double length = glm::length(d);
  return length > 0 ? std::abs(d.x * (p.y - a.y) - d.y * (p.x - a.x)) / length : glm::length(p - a);
}

} // namespace

Pixels displacement_picture(const CompareReport& report, int width, int height, double full_scale_px) {
  if (!(full_scale_px > 0) || report.verdicts.size() != std::size_t(width) * std::size_t(height))
    throw Error(ErrorCode::usage, "compare: a displacement picture needs a positive scale and the size of its report");
  const double unit = std::max(8.0, width / 48.0);
  Pixels heat_map = blank(width, height);
  for (std::size_t i = 0; i < report.verdicts.size(); ++i)
    paint(heat_map, i, displacement_colour(report, i, full_scale_px));
  Canvas canvas(width, height + static_cast<int>(std::ceil(3.4 * unit)), {});
  canvas.picture(heat_map, 0, 0, width, height);
  draw_scale(canvas, width, height, unit, full_scale_px);
  return canvas.pixels();
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

Pixels crack_picture(const CompareReport& report, const Frame& warped) {
  const std::size_t count = report.verdicts.size();
  const auto is_overlap = [&](std::size_t i) { return !report.covers.empty() && report.covers[i] > 1; };
  Pixels pixels = blank(warped.width, warped.height);
  for (std::size_t i = 0; i < count; ++i) {
    const Verdict verdict = report.verdicts[i];
    const std::uint8_t* p = &warped.rgba[4 * i];
    Colour colour = {static_cast<std::uint8_t>(p[0] / 3), static_cast<std::uint8_t>(p[1] / 3),
                     static_cast<std::uint8_t>(p[2] / 3)};
    if (verdict == Verdict::depth_tie) colour = {64, 160, 255};
    if (is_overlap(i)) colour = yellow;
    if (is_mismatch(verdict)) colour = white;
    if (is_pinhole(verdict)) colour = magenta;
    paint(pixels, i, colour);
  }
  Canvas canvas(warped.width, warped.height, {});
  canvas.picture(pixels, 0, 0, warped.width, warped.height);
  draw_rings(canvas, warped.width, count, {255, 230, 0}, is_overlap);
  draw_rings(canvas, warped.width, count, {255, 255, 255}, [&](std::size_t i) { return is_mismatch(report.verdicts[i]); });
  draw_rings(canvas, warped.width, count, {255, 0, 255}, [&](std::size_t i) { return is_pinhole(report.verdicts[i]); });
  return canvas.pixels();
}

Pixels wireframe_picture(const Frame& warped, const Screen& screen) {
  Pixels pixels = colours(warped);
  constexpr double half_width = 0.5, opacity = 0.8;
  parallel_each(std::size_t(warped.height), 16, [&](std::size_t row) {
    for (std::size_t column = 0; column < std::size_t(warped.width); ++column) {
      const std::size_t i = row * std::size_t(warped.width) + column;
      const ScreenTriangle* t = find_triangle(screen, warped.object[i], warped.triangle[i] - 1);
      if (!t) continue;
      const Vec2 centre(double(column) + 0.5, double(row) + 0.5);
      double distance = half_width + 0.5;
      for (std::size_t k = 0; k < 3; ++k)
        distance = std::min(distance, distance_to_edge(centre, t->corners[k].pixel, t->corners[(k + 1) % 3].pixel));
      const double share = opacity * std::clamp(half_width + 0.5 - distance, 0.0, 1.0);
      Colour colour;
      for (std::size_t k = 0; k < 3; ++k)
        colour[k] = static_cast<std::uint8_t>(std::lround((1 - share) * pixels.rgba[4 * i + k] + share * white[k]));
      paint(pixels, i, colour);
    }
  });
  return pixels;
}

} // namespace domewarp
