// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/svg.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "domewarp/core/markup.h"

namespace domewarp {

namespace {

constexpr double widest = 640, tallest = 760; // of the window, pixels
constexpr double left = 56, top = 40, bottom = 34, legend_width = 220, line_height = 17;

// Fixed digits, whatever the locale.
std::string fixed(double value, int digits) {
  std::array<char, 64> text{};
  const double bounded = std::clamp(value, -1e7, 1e7);
  const auto end = std::to_chars(text.data(), text.data() + text.size(), bounded, std::chars_format::fixed, digits).ptr;
  return {text.data(), end};
}

std::string px(double value) { return fixed(value, 2); }

// Names of files may be in any encoding, the drawing is UTF-8.
std::string printable(std::string_view text) {
  std::string result(text);
  std::replace_if(result.begin(), result.end(), [](char c) { return c < ' ' || c >= 0x7f; }, '?');
  return result;
}

std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  return std::string(text.substr(0, most)) + "...";
}

std::string text_at(double x, double y, std::string_view text, std::string_view style = "") {
  return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" " + std::string(style) + ">" + escape_markup(printable(text)) + "</text>\n";
}

// 1, 2 or 5 times a power of ten, so that about `count` steps fit into `range`.
double round_step(double range, double count) {
  const double rough = range / count, power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough) return factor * power;
  return 10 * power;
}

std::string mark(const LegendEntry& entry, double x, double y) {
  switch (entry.mark) {
  case LegendMark::line:
    return "<path d=\"M" + px(x) + " " + px(y) + "h26\" " + entry.style + "/>\n";
  case LegendMark::area:
    return "<rect x=\"" + px(x) + "\" y=\"" + px(y - 6) + "\" width=\"26\" height=\"12\" " + entry.style + "/>\n";
  default:
    return "<circle cx=\"" + px(x + 13) + "\" cy=\"" + px(y) + "\" r=\"4\" " + entry.style + "/>\n";
  }
}

} // namespace

SvgPlot::SvgPlot(const PlotWindow& window) : window_(window) {
  const double height = window.high - window.low;
  scale_ = std::min(widest / (2 * window.width), tallest / height);
  size_ = {2 * window.width * scale_, height * scale_};
}

double SvgPlot::unit() const { return 1 / scale_; }
double SvgPlot::reach() const {
  return std::hypot(window_.width, std::max(std::abs(window_.low), std::abs(window_.high)));
}

Vec2 SvgPlot::pixel(const Vec2& p) const {
  return {left + (p.x + window_.width) * scale_, top + (window_.high - p.y) * scale_};
}

std::string SvgPlot::points(const std::vector<Vec2>& path) const {
  std::string text;
  for (const Vec2& p : path) {
    const Vec2 at = pixel(p);
    text += text.empty() ? 'M' : 'L';
    text += px(at.x) + " " + px(at.y);
  }
  return text;
}

void SvgPlot::grid() {
  const double step = round_step(2 * window_.width, 8);
  const int digits = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  const auto label = [&](double value) { return fixed(std::abs(value) < 1e-6 * step ? 0 : value, digits); };
  for (double x = step * std::ceil(-window_.width / step); x <= window_.width; x += step) {
    line({{x, window_.low}, {x, window_.high}}, R"(stroke="#e6e6e6")");
    labels_ += text_at(pixel({x, 0}).x, top + size_.y + 15, label(x), R"(text-anchor="middle")");
  }
  for (double y = step * std::ceil(window_.low / step); y <= window_.high; y += step) {
    line({{-window_.width, y}, {window_.width, y}}, R"(stroke="#e6e6e6")");
    labels_ += text_at(left - 6, pixel({0, y}).y + 4, label(y), R"(text-anchor="end")");
  }
  line({{0, window_.low}, {0, window_.high}}, R"(stroke="#999")");
  labels_ += text_at(left + size_.x - 4, top + size_.y + 29, "r (image units)", R"(text-anchor="end")");
  labels_ += text_at(left - 6, top - 8, "z", R"(text-anchor="end")");
}

void SvgPlot::line(const std::vector<Vec2>& path, std::string_view style) {
  if (path.size() >= 2) body_ += "<path d=\"" + points(path) + "\" " + std::string(style) + "/>\n";
}

void SvgPlot::shape(const std::vector<Vec2>& outline, std::string_view style) {
  if (outline.size() >= 3) body_ += "<path d=\"" + points(outline) + "Z\" " + std::string(style) + "/>\n";
}

void SvgPlot::dot(const Vec2& centre, double pixels, std::string_view style) {
  const Vec2 at = pixel(centre);
  body_ += "<circle cx=\"" + px(at.x) + "\" cy=\"" + px(at.y) + "\" r=\"" + px(pixels) + "\" " + std::string(style) + "/>\n";
}

std::string SvgPlot::finish(std::string_view title, const std::vector<LegendEntry>& legend,
                            const std::vector<std::string>& notes) {
  constexpr std::size_t title_length = 90, note_length = 140;
  const double legend_height = line_height * static_cast<double>(legend.size());
  const double notes_top = top + std::max(size_.y + bottom, legend_height) + line_height;
  constexpr double character = 6.6; // wide, at most on average
  std::size_t longest = 0;
  for (const std::string& note : notes) longest = std::max(longest, std::min(note.size(), note_length));
  const double width = left + std::max(size_.x + legend_width, character * static_cast<double>(longest));
  const double height = notes_top + line_height * static_cast<double>(notes.size());
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + px(width) + " " + px(height) +
                    "\" width=\"" + px(width) + "\" height=\"" + px(height) +
                    "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n";
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  svg += text_at(left, 22, shortened(title, title_length), R"(font-size="15" font-weight="bold")");
  // A window of its own clips without an id, so that several drawings can stand in one page.
  svg += "<svg x=\"" + px(left) + "\" y=\"" + px(top) + "\" width=\"" + px(size_.x) + "\" height=\"" + px(size_.y) +
         "\" viewBox=\"" + px(left) + " " + px(top) + " " + px(size_.x) + " " + px(size_.y) + "\">\n" + body_ + "</svg>\n";
  svg += "<rect x=\"" + px(left) + "\" y=\"" + px(top) + "\" width=\"" + px(size_.x) + "\" height=\"" + px(size_.y) +
         "\" fill=\"none\" stroke=\"#888\"/>\n" + labels_;
  double y = top + 8;
  for (const LegendEntry& entry : legend) {
    svg += mark(entry, left + size_.x + 14, y) + text_at(left + size_.x + 48, y + 4, entry.text);
    y += line_height;
  }
  y = notes_top;
  for (const std::string& note : notes) {
    svg += text_at(left, y, shortened(note, note_length));
    y += line_height;
  }
  return svg + "</svg>\n";
}

} // namespace domewarp
