// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

#include "chart.h"
#include "domewarp/core/markup.h"

namespace domewarp::bench {

namespace {

// Pixels: the plot's box, with room for labels on the left and below and the legend on the right.
constexpr double left = 80, top = 44, width = 560, height = 400, legend = left + width + 24, full_width = 960, full_height = 524;

struct Style {
  const char* colour;
  const char* dash;
};
constexpr std::array<Style, 8> styles{{{"#1f4e9c", ""},
                                       {"#c2410c", "7 3"},
                                       {"#15803d", "2 3"},
                                       {"#7e22ce", "9 3 2 3"},
                                       {"#0e7490", "4 2"},
                                       {"#a16207", "12 4"},
                                       {"#be123c", "1 2"},
                                       {"#404040", "6 2 1 2 1 2"}}};

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

struct Tick {
  double value;
  std::string label; ///< empty: a minor tick
};

/// One axis with its range and ticks. `place` gives 0 to 1 along it.
struct Scale {
  bool log = false;
  double low = 0, high = 1;
  std::vector<Tick> ticks{};

  bool shows(double value) const { return std::isfinite(value) && (!log || value > 0); }
  double place(double value) const {
    return log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  }
};

void widen_log(Scale& scale) {
  const double first = std::floor(std::log10(scale.low) + 1e-9), last = std::max(std::ceil(std::log10(scale.high) - 1e-9), first + 1);
  scale.low = std::pow(10, first);
  scale.high = std::pow(10, last);
  const int step = static_cast<int>(std::ceil((last - first) / 10));
  for (int exponent = static_cast<int>(first); exponent <= last; ++exponent) {
    const double decade = std::pow(10, exponent);
    const bool short_range = last - first <= 2;
    scale.ticks.push_back({decade, (exponent - static_cast<int>(first)) % step == 0 ? number(decade) : ""});
    for (const int digit : {2, 5})
      if (exponent < last && step == 1) scale.ticks.push_back({digit * decade, short_range ? number(digit * decade) : ""});
  }
}

void widen_linear(Scale& scale) {
  if (scale.high == scale.low) scale.high += 1;
  const double rough = (scale.high - scale.low) / 6, decade = std::pow(10, std::floor(std::log10(rough)));
  const double step = decade * (rough > 5 * decade ? 10 : rough > 2 * decade ? 5 : 2);
  scale.low = std::floor(scale.low / step) * step;
  scale.high = std::ceil(scale.high / step) * step;
  for (int i = 0; scale.low + i * step <= scale.high + 0.5 * step; ++i) scale.ticks.push_back({scale.low + i * step, number(scale.low + i * step)});
}

Scale make_scale(const Axis& axis, const std::vector<Series>& series, int dimension) {
  Scale scale{axis.log};
  if (!axis.categories.empty()) {
    scale.low = -0.5;
    scale.high = static_cast<double>(axis.categories.size()) - 0.5;
    for (std::size_t i = 0; i < axis.categories.size(); ++i) scale.ticks.push_back({static_cast<double>(i), axis.categories[i]});
    return scale;
  }
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Series& one : series)
    for (const Vec2& point : one.points)
      if (scale.shows(point[dimension])) low = std::min(low, point[dimension]), high = std::max(high, point[dimension]);
  if (low > high) low = high = 1;
  scale.low = axis.log ? low : std::min(low, 0.0); // a length that starts elsewhere than at 0 misleads
  scale.high = high;
  axis.log ? widen_log(scale) : widen_linear(scale);
  return scale;
}

void draw_marker(std::ostream& out, std::size_t series, double x, double y, const char* colour) {
  const auto polygon = [&](std::initializer_list<Vec2> corners) {
    out << "<polygon points=\"";
    for (const Vec2& corner : corners) out << x + corner.x << ',' << y + corner.y << ' ';
    out << "\" fill=\"" << colour << "\"/>\n";
  };
  switch (series % 4) {
  case 0: out << "<circle cx=\"" << x << "\" cy=\"" << y << "\" r=\"4\" fill=\"" << colour << "\"/>\n"; break;
  case 1: polygon({{-4, -4}, {4, -4}, {4, 4}, {-4, 4}}); break;
  case 2: polygon({{0, -5.5}, {5, 4}, {-5, 4}}); break;
  default: polygon({{0, -5.5}, {5.5, 0}, {0, 5.5}, {-5.5, 0}});
  }
}

void draw_text(std::ostream& out, double x, double y, const char* anchor, const std::string& text, const char* more = "") {
  out << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\" " << more << '>' << escape_markup(text) << "</text>\n";
}

void draw_ticks(std::ostream& out, const Scale& scale, bool vertical) {
  for (const Tick& tick : scale.ticks) {
    const double place = scale.place(tick.value);
    if (place < -1e-9 || place > 1 + 1e-9) continue;
    const double x = left + width * (vertical ? 0 : place), y = top + height * (vertical ? 1 - place : 1);
    const bool minor = tick.label.empty();
    out << "<line x1=\"" << x << "\" y1=\"" << y << "\" x2=\"" << (vertical ? left + width : x) << "\" y2=\""
        << (vertical ? y : top) << "\" stroke=\"" << (minor ? "#eeeeee" : "#cccccc") << "\"/>\n";
    if (vertical) draw_text(out, x - 8, y + 4, "end", tick.label);
    else draw_text(out, x, y + 18, "middle", tick.label);
  }
}

void draw_series(std::ostream& out, const Series& series, std::size_t index, const Scale& x_scale, const Scale& y_scale) {
  const Style& style = styles[index % styles.size()];
  std::vector<Vec2> places;
  for (const Vec2& point : series.points)
    if (x_scale.shows(point.x) && y_scale.shows(point.y))
      places.emplace_back(left + width * x_scale.place(point.x), top + height * (1 - y_scale.place(point.y)));
  if (series.line && places.size() > 1) {
    out << "<polyline fill=\"none\" stroke-width=\"1.6\" stroke=\"" << style.colour << "\" stroke-dasharray=\"" << style.dash << "\" points=\"";
    for (const Vec2& place : places) out << place.x << ',' << place.y << ' ';
    out << "\"/>\n";
  }
  for (const Vec2& place : places) draw_marker(out, index, place.x, place.y, style.colour);
  const double y = top + 10 + 20 * static_cast<double>(index);
  if (series.line)
    out << "<line x1=\"" << legend << "\" y1=\"" << y << "\" x2=\"" << legend + 32 << "\" y2=\"" << y << "\" stroke-width=\"1.6\" stroke=\""
        << style.colour << "\" stroke-dasharray=\"" << style.dash << "\"/>\n";
  draw_marker(out, index, legend + 16, y, style.colour);
  draw_text(out, legend + 40, y + 4, "start", series.name);
}

} // namespace

std::string to_svg(const Plot& plot, const std::string& footer) {
  const Scale x = make_scale(plot.x, plot.series, 0), y = make_scale(plot.y, plot.series, 1);
  std::ostringstream out;
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << full_width << ' ' << full_height << "\" width=\"" << full_width
      << "\" height=\"" << full_height << "\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\" fill=\"#111111\">\n"
      << "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  draw_ticks(out, x, false);
  draw_ticks(out, y, true);
  out << "<rect x=\"" << left << "\" y=\"" << top << "\" width=\"" << width << "\" height=\"" << height << "\" fill=\"none\" stroke=\"#111111\"/>\n";
  for (std::size_t i = 0; i < plot.series.size(); ++i) draw_series(out, plot.series[i], i, x, y);
  draw_text(out, left, 26, "start", plot.title, "font-size=\"16\" font-weight=\"bold\"");
  draw_text(out, left + width / 2, top + height + 42, "middle", plot.x.label);
  const double middle = top + height / 2;
  draw_text(out, 20, middle, "middle", plot.y.label, ("transform=\"rotate(-90 20 " + number(middle) + ")\"").c_str());
  draw_text(out, left, full_height - 10, "start", footer, "font-size=\"11\" fill=\"#555555\"");
  out << "</svg>\n";
  return out.str();
}

} // namespace domewarp::bench
