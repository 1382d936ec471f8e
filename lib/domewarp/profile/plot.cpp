// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/plot.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "domewarp/core/errors.h"
#include "domewarp/profile/facts.h"
#include "domewarp/profile/svg.h"

namespace domewarp {

namespace {

constexpr double pi = std::numbers::pi;

constexpr const char* visible_style = R"(fill="none" stroke="#c8102e" stroke-width="3" stroke-linejoin="round")";
constexpr const char* hidden_style = R"(fill="none" stroke="#333" stroke-width="1.4")";
constexpr const char* tangent_style = R"(fill="none" stroke="#1f5fbf" stroke-width="1.6" stroke-dasharray="7 4")";
constexpr const char* ray_style = R"(fill="none" stroke="#5b8db8" stroke-width="0.8")";
constexpr const char* feed_style = R"(fill="none" stroke="#d98200" stroke-width="0.9" stroke-dasharray="3 3")";
constexpr const char* plane_style = R"(fill="none" stroke="#222" stroke-width="4")";
constexpr const char* blind_style = R"(fill="#d5d5d5" stroke="none")";
constexpr const char* hit_style = R"(fill="#fff" stroke="#c8102e" stroke-width="1.4")";
constexpr const char* extended_hit_style = R"(fill="#fff" stroke="#1f5fbf" stroke-width="1.2")";
constexpr const char* turn_style = R"(fill="#c8102e" stroke="none")";
constexpr const char* kink_style = R"(fill="#7b3fa0" stroke="none")";
constexpr const char* eye_style = R"(fill="#111" stroke="none")";
constexpr const char* projector_style = R"(fill="#d98200" stroke="none")";

using Path = std::vector<Vec2>;

// Points of a curve so dense that its polyline looks smooth: halves a step while its middle lies off the chord.
void flatten(const std::function<Vec2(double)>& point, double a, double b, double accuracy, int depth, Path& path) {
  const double middle = 0.5 * (a + b);
  const Vec2 from = point(a), to = point(b), at = point(middle);
  const Vec2 chord = to - from, off = at - from;
  const double length = std::max(std::hypot(chord.x, chord.y), 1e-300);
  const bool flat = std::abs(chord.x * off.y - chord.y * off.x) <= accuracy * length && length < 60 * accuracy;
  if (flat || depth == 0) {
    path.push_back(to);
    return;
  }
  flatten(point, a, middle, accuracy, depth - 1, path);
  flatten(point, middle, b, accuracy, depth - 1, path);
}

Path flatten(const std::function<Vec2(double)>& point, double a, double b, double accuracy) {
  Path path{point(a)};
  constexpr int depth = 13;
  flatten(point, a, b, accuracy, depth, path);
  std::erase_if(path, [](const Vec2& p) { return !std::isfinite(p.x) || !std::isfinite(p.y); });
  return path;
}

double flatness(const SvgPlot& plot) { return 0.25 * plot.unit(); }

Path visible_path(const Surface& surface, double accuracy) {
  return flatten([&](double radius) { return *surface.meridian(std::min(radius, surface.r_max())); }, 0, surface.r_max(), accuracy);
}

// The surface as given, also where nothing of it is shown; empty where it cannot be followed.
Path whole_path(const Surface& surface, double reach, double accuracy) try {
  SurfaceOptions options = surface.options();
  options.rmax.reset();
  options.projector.reset();
  options.branches = BranchChoice::all;
  const Surface whole(options, reach);
  return flatten([&](double radius) { return *whole.meridian(std::min(radius, whole.r_max())); }, 0, whole.r_max(), accuracy);
} catch (const Error&) {
  return {};
}

// What part of (r, z) space the picture shows. Chosen so that eye, image plane and visible surface are in it, and the
// projector if it is not far away.
PlotWindow choose_window(const Surface& surface) {
  double width = std::max({surface.r_max(), surface.rim().point.x});
  double low = 0, high = 0;
  for (int i = 0; i <= 64; ++i) { // for the frame only
    const Vec2 p = *surface.meridian(std::min(surface.r_max() * i / 64, surface.r_max()));
    if (!std::isfinite(p.x + p.y)) continue;
    width = std::max(width, p.x);
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  width *= 1.2;
  const double most = 3.2 * width;
  const double projector = surface.options().projector.value_or(0);
  if (projector <= most) low = std::min(low, -projector);
  low = std::max(low, -most);
  high = std::min(high, most);
  const double margin = 0.12 * width + 0.05 * (high - low);
  return {width, std::min(low - margin, -0.45 * width), std::max(high + margin, 0.45 * width)};
}

double ray_step(const Surface& surface) {
  const Vec2 range = visible_range(surface);
  const double degrees = (range.y - range.x) * 180 / pi;
  for (const double step : {1.0, 2.0, 5.0, 10.0})
    if (degrees <= 11 * step) return step * pi / 180;
  return 15 * pi / 180;
}

// Where a view ray meets the visible surface, nearest first, and the tangent extension.
struct Crossings {
  std::vector<Vec2> visible;
  std::optional<Vec2> extended;
};

Crossings cross(const Surface& surface, double theta) {
  Crossings found;
  const double s = std::sin(theta), c = std::cos(theta);
  for (std::size_t i = 0; i < surface.branches().size(); ++i) {
    const Branch& branch = surface.branches()[i];
    if (theta < branch.theta_low || theta > branch.theta_high) continue;
    if (const auto point = surface.meridian(surface.radius(i, s, c))) found.visible.push_back(*point);
  }
  const auto& [point, tangent] = surface.rim();
  const double slant = c * tangent.x - s * tangent.y;
  if (found.visible.empty() && surface.extended_radius({s, 0, -c}))
    found.extended = (point.y * tangent.x - point.x * tangent.y) / slant * Vec2(s, c);
  return found;
}

Path mirror(Path path, double side) {
  for (Vec2& p : path) p.x *= side;
  return path;
}

void draw_blind_cone(SvgPlot& plot, const Surface& surface) {
  const BlindCone blind = surface.blind();
  const double far = 4 * plot.reach();
  for (const double side : {-1.0, 1.0}) {
    Path wedge{{0, 0}};
    for (int i = 0; i <= 16; ++i) {
      const double theta = blind.theta_low + (blind.theta_high - blind.theta_low) * i / 16;
      wedge.emplace_back(side * far * std::sin(theta), far * std::cos(theta));
    }
    plot.shape(wedge, blind_style);
  }
}

void draw_ray(SvgPlot& plot, const Crossings& crossings, double side) {
  const bool shown = !crossings.visible.empty();
  if (!shown && !crossings.extended) return;
  Vec2 end = shown ? crossings.visible.front() : *crossings.extended;
  for (const Vec2& hit : crossings.visible)
    if (std::hypot(hit.x, hit.y) > std::hypot(end.x, end.y)) end = hit;
  plot.line(mirror({{0, 0}, end}, side), ray_style);
  for (const Vec2& hit : mirror(crossings.visible, side)) plot.dot(hit, 2.6, hit_style);
  if (crossings.extended) plot.dot({side * crossings.extended->x, crossings.extended->y}, 2.6, extended_hit_style);
}

void draw_rays(SvgPlot& plot, const Surface& surface) {
  const double step = ray_step(surface);
  const Vec2 range = visible_range(surface);
  for (double theta = 0; theta <= pi + 1e-9; theta += theta > range.y ? 15 * pi / 180 : step) {
    const Crossings crossings = cross(surface, std::min(theta, pi));
    for (const double side : {-1.0, 1.0}) draw_ray(plot, crossings, side);
  }
}

// How the image plane's points reach the surface: along the axis, or from the projector.
void draw_feed(SvgPlot& plot, const Surface& surface) {
  constexpr int count = 6;
  for (int i = 1; i <= count; ++i) {
    const double radius = std::min(surface.r_max() * i / count, surface.r_max()); // may round up
    const Vec2 point = *surface.meridian(radius), start(radius, 0);
    for (const double side : {-1.0, 1.0}) {
      Path path{start, point};
      if (surface.options().projector) path.insert(path.begin(), Vec2(0, -*surface.options().projector));
      plot.line(mirror(path, side), feed_style);
    }
  }
}

bool goes_on(const Surface& surface, const Path& whole) {
  return !whole.empty() && whole.back().x > surface.rim().point.x * (1 + 1e-9);
}

void draw_surface(SvgPlot& plot, const Surface& surface, const Path& whole) {
  const Path visible = visible_path(surface, flatness(plot));
  const auto& [point, tangent] = surface.rim();
  const Path extension{point, point + 4 * plot.reach() * tangent};
  for (const double side : {-1.0, 1.0}) {
    if (goes_on(surface, whole)) plot.line(mirror(whole, side), hidden_style);
    plot.line(mirror(extension, side), tangent_style);
    plot.line(mirror(visible, side), visible_style);
    for (const Kink& kink : surface.kinks())
      if (kink.kind != KinkKind::joint) plot.dot({side * kink.r, kink.z}, 4, kink_style);
  }
}

void draw_turns(SvgPlot& plot, const Surface& surface) {
  for (const Branch& branch : surface.branches())
    for (const auto& [fold, radius] :
         {std::pair(branch.fold_low, branch.radius_low), std::pair(branch.fold_high, branch.radius_high)})
      if (const auto point = surface.meridian(radius); fold && point)
        for (const double side : {-1.0, 1.0}) plot.dot({side * point->x, point->y}, 4, turn_style);
}

void draw_stations(SvgPlot& plot, const Surface& surface) {
  plot.line({{-surface.r_max(), 0}, {surface.r_max(), 0}}, plane_style);
  plot.dot({0, 0}, 5, eye_style);
  if (surface.options().projector) plot.dot({0, -*surface.options().projector}, 6, projector_style);
}

std::vector<LegendEntry> legend(const Surface& surface, bool is_part) {
  const bool extended = surface.rim().tangent != Vec2(0, 0);
  const BlindCone blind = surface.blind();
  const auto& kinks = surface.kinks();
  const auto is_plotted = [](const Kink& kink) { return kink.kind != KinkKind::joint; };
  const auto folds = [](const Branch& branch) { return branch.fold_low || branch.fold_high; };
  std::vector<LegendEntry> entries{{"surface, visible part", visible_style, LegendMark::line}};
  if (is_part) entries.push_back({"surface, not shown", hidden_style, LegendMark::line});
  if (extended) entries.push_back({"tangent extension", tangent_style, LegendMark::line});
  if (blind.theta_low < blind.theta_high) entries.push_back({"blind directions", blind_style, LegendMark::area});
  entries.push_back({"view ray", ray_style, LegendMark::line});
  entries.push_back({"where it meets the surface", hit_style, LegendMark::dot});
  if (extended) entries.push_back({"where it meets the tangent", extended_hit_style, LegendMark::dot});
  if (std::any_of(surface.branches().begin(), surface.branches().end(), folds))
    entries.push_back({"view angle turns (fold)", turn_style, LegendMark::dot});
  if (std::any_of(kinks.begin(), kinks.end(), is_plotted))
    entries.push_back({"corner or vertical tangent", kink_style, LegendMark::dot});
  entries.push_back({"image plane", plane_style, LegendMark::line});
  const bool projected = surface.options().projector.has_value();
  entries.push_back({projected ? "projector's ray" : "image point to surface", feed_style, LegendMark::line});
  entries.push_back({"eye", eye_style, LegendMark::dot});
  if (projected) entries.push_back({"projector", projector_style, LegendMark::dot});
  return entries;
}

} // namespace

std::string plot_svg(const Surface& surface) {
  SvgPlot plot(choose_window(surface));
  draw_blind_cone(plot, surface);
  plot.grid();
  draw_feed(plot, surface);
  draw_rays(plot, surface);
  const Path whole = whole_path(surface, plot.reach(), flatness(plot));
  draw_surface(plot, surface, whole);
  draw_turns(plot, surface);
  draw_stations(plot, surface);
  return plot.finish(name_of(surface), legend(surface, goes_on(surface, whole)), summarise(surface));
}

} // namespace domewarp
