// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "domewarp/core/vectors.h"

namespace domewarp {

/// The part of a plane that a plot shows: x from -width to width, y from low to high, the same scale both ways.
struct PlotWindow {
  double width = 1, low = -1, high = 1;
};

enum class LegendMark { line, area, dot };

struct LegendEntry {
  std::string text;
  std::string style; ///< SVG attributes, as given to the drawing functions
  LegendMark mark = LegendMark::line;
};

/// Builds an SVG drawing with axes. Coordinates are the window's; what lies outside it is clipped. Styles are SVG
/// attributes; texts are escaped.
class SvgPlot {
public:
  explicit SvgPlot(const PlotWindow& window);

  double unit() const; ///< length of a pixel
  double reach() const; ///< no point of the window is farther from the origin

  void grid(); ///< lines at round numbers, with the numbers
  void line(const std::vector<Vec2>& path, std::string_view style);
  void shape(const std::vector<Vec2>& outline, std::string_view style);
  void dot(const Vec2& centre, double pixels, std::string_view style);

  /// The whole drawing: a title above, the legend beside, notes below. Call once, last.
  std::string finish(std::string_view title, const std::vector<LegendEntry>& legend,
                     const std::vector<std::string>& notes);

private:
  Vec2 pixel(const Vec2& p) const;
  std::string points(const std::vector<Vec2>& path) const;

  PlotWindow window_;
  double scale_ = 1; ///< pixels per unit
  Vec2 size_{0, 0};  ///< of the window, pixels
  std::string body_, labels_;
};

} // namespace domewarp
