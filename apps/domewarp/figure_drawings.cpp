// SPDX-License-Identifier: Apache-2.0
#include "figure_drawings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "domewarp/render/canvas.h"

namespace domewarp {

namespace {

constexpr Ink paper = {255, 255, 255}, ink = {30, 30, 36}, grey = {170, 172, 178}, red = {214, 32, 32}, blue = {40, 90, 190};

/// Where (r, z) of a cross-section lies on the canvas.
struct Frame2 {
  double scale, left, bottom;
  Vec2 operator()(const Vec2& p) const { return {left + p.x * scale, bottom - p.y * scale}; }
};

/// The curve on both sides of the axis from image radius `from` to `to`.
std::vector<Vec2> curve_between(const Surface& surface, double from, double to, int side) {
  std::vector<Vec2> path;
  constexpr int steps = 400;
  for (int i = 0; i <= steps; ++i)
    if (const auto point = surface.meridian(std::min(from + (to - from) * i / steps, surface.r_max() * (1 - 1e-12)))) path.push_back({side * point->x, point->y});
  return path;
}

std::vector<Vec2> placed(const Frame2& frame, const std::vector<Vec2>& path) {
  std::vector<Vec2> result;
  for (const Vec2& p : path) result.push_back(frame(p));
  return result;
}

/// The piece of the curve from image radius `from` that is `length` long.
double end_of_piece(const Surface& surface, double from, double length) {
  double at = from, sum = 0;
  Vec2 last = *surface.meridian(from);
  constexpr double step = 1e-4;
  while (sum < length && at + step < surface.r_max()) {
    at += step;
    const Vec2 next = *surface.meridian(at);
    sum += glm::length(next - last);
    last = next;
  }
  return at;
}

void draw_piece(Canvas& canvas, const Frame2& frame, const Surface& surface, double from, double to, double plane) {
  canvas.line(placed(frame, curve_between(surface, from, to, 1)), red, 4);
  for (const double r : {from, to}) canvas.line({frame(*surface.meridian(r)), frame({r, plane})}, grey, 1);
  canvas.line({frame({from, plane}), frame({to, plane})}, red, 4);
}

} // namespace

Pixels enlarge(const Pixels& pixels, const Crop& crop) {
  const int left = static_cast<int>(crop.left * pixels.width), top = static_cast<int>(crop.top * pixels.height);
  const int width = std::max(1, static_cast<int>(crop.width * pixels.width)), height = std::max(1, static_cast<int>(crop.height * pixels.height));
  const int factor = std::max(1, static_cast<int>(std::lround(1 / crop.width)));
  Pixels result{width * factor, height * factor, {}};
  result.rgba.reserve(4 * std::size_t(result.width) * std::size_t(result.height));
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) {
      const int column = std::min(left + x / factor, pixels.width - 1), row = std::min(top + y / factor, pixels.height - 1);
      const std::uint8_t* p = &pixels.rgba[4 * (std::size_t(row) * std::size_t(pixels.width) + std::size_t(column))];
      result.rgba.insert(result.rgba.end(), p, p + 4);
    }
  return result;
}

Pixels mark(const Pixels& pixels, const Crop& crop) {
  Canvas canvas(pixels.width, pixels.height, {});
  canvas.picture(pixels, 0, 0, pixels.width, pixels.height);
  const double l = crop.left * pixels.width, t = crop.top * pixels.height, r = l + crop.width * pixels.width, b = t + crop.height * pixels.height;
  canvas.line({{l, t}, {r, t}, {r, b}, {l, b}, {l, t}}, {255, 40, 40}, std::max(1.5, pixels.width / 300.0));
  return canvas.pixels();
}

Pixels cross_section(const SurfaceOptions& options, const Raster& shape, const Raster& raster, bool segments) {
  constexpr double reach = 2.2; // image radius that is drawn
  const Surface visible(options, screen_radius(shape));
  SurfaceOptions all = options;
  all.rmax.reset();
  const Surface whole(all, reach);
  double low = -0.25, high = 0.4;
  for (const Vec2& p : curve_between(whole, 0, std::min(reach, whole.r_max()), 1)) low = std::min(low, p.y), high = std::max(high, p.y);
  low = std::max(low, std::min(-0.25, visible.meridian(visible.r_max() * (1 - 1e-9))->y) - 0.6);
  const double plane = low - 0.35;
  const double size = std::max(9.0, raster.height / 26.0), label = 1.8 * size; // a band below for what is drawn
  const double scale = std::min(raster.width / (2.1 * reach), (raster.height - label) / (high - plane + 0.35));
  const Frame2 frame{scale, 0.5 * raster.width, raster.height - label - 0.1 * scale + plane * scale};
  Canvas canvas(raster.width, raster.height, paper);
  canvas.line({frame({-reach, 0}), frame({reach, 0})}, grey, 1);
  canvas.line({frame({0, plane}), frame({0, high + 0.2})}, grey, 1);
  for (const int side : {-1, 1}) {
    canvas.line(placed(frame, curve_between(whole, 0, std::min(reach, whole.r_max()), side)), blue, 1.5);
    if (!segments) canvas.line(placed(frame, curve_between(visible, 0, visible.r_max(), side)), red, 3);
  }
  constexpr int rays = 9;
  for (int i = -rays; i <= rays && !segments; ++i) {
    const auto point = visible.meridian(visible.r_max() * std::abs(i) / rays * (1 - 1e-9));
    if (point) canvas.line({frame({0, 0}), frame({i < 0 ? -point->x : point->x, point->y})}, {110, 112, 120, 0.5}, 1);
  }
  const double edge = std::min(aspect(shape), visible.r_max());
  canvas.line({frame({-edge, plane}), frame({edge, plane})}, ink, 3);
  if (segments) {
    draw_piece(canvas, frame, visible, 0.05, end_of_piece(visible, 0.05, 0.35), plane);
    const double start = 0.86 * visible.r_max();
    draw_piece(canvas, frame, visible, start, end_of_piece(visible, start, 0.35), plane);
  }
  canvas.ring(frame({0, 0}), 0.012 * raster.width, ink, 2);
  canvas.rectangle(0, raster.height - label, raster.width, label, paper);
  canvas.text(8, raster.height - 0.5 * size, size, "f(r) = " + options.curve, ink);
  return canvas.pixels();
}

Pixels contact_sheet(const std::vector<Figure>& figures, int columns, int width) {
  constexpr int gap = 4;
  const double size = width / 16.0;
  const int height = width * 3 / 4, cell = height + static_cast<int>(1.5 * size) + gap;
  const int rows = (static_cast<int>(figures.size()) + columns - 1) / columns;
  Canvas canvas(columns * (width + gap) + gap, rows * cell + gap, paper);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const Pixels& p = figures[i].pixels;
    const std::size_t column = i % std::size_t(columns), row = i / std::size_t(columns);
    const double left = gap + static_cast<double>(column) * (width + gap), top = gap + static_cast<double>(row) * cell;
    const double scale = std::min(double(width) / p.width, double(height) / p.height), w = p.width * scale, h = p.height * scale;
    canvas.rectangle(left, top, width, height, {20, 20, 24});
    canvas.picture(p, left + 0.5 * (width - w), top + 0.5 * (height - h), w, h);
    canvas.text(left, top + height + 1.1 * size, size, figures[i].name + "  " + figures[i].caption, ink);
  }
  return canvas.pixels();
}

} // namespace domewarp
