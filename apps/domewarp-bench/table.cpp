// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "chart.h"

namespace domewarp::bench {

namespace {

std::string for_people(const Cell& cell) {
  if (const auto* word = std::get_if<std::string>(&cell)) return *word;
  const double value = std::get<double>(cell);
  if (!std::isfinite(value)) return "-";
  std::array<char, 32> text{};
  const bool whole = value == std::floor(value) && std::abs(value) < 1e9;
  std::snprintf(text.data(), text.size(), whole ? "%.0f" : "%.4g", value);
  return text.data();
}

std::string for_machines(const Cell& cell) {
  if (const auto* word = std::get_if<std::string>(&cell)) {
    if (word->find_first_of(",\"\n") == std::string::npos) return *word;
    std::string quoted = "\"";
    for (const char c : *word) quoted.append(c == '"' ? 2 : 1, c);
    return quoted + '"';
  }
  const double value = std::get<double>(cell);
  if (!std::isfinite(value)) return "";
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::vector<std::size_t> widths_of(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    std::size_t width = table.columns[i].heading.size();
    for (const auto& row : table.rows) width = std::max(width, for_people(row[i]).size());
    widths.push_back(width);
  }
  return widths;
}

} // namespace

std::string three_digits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

double log_log_slope(const std::vector<Vec2>& points) {
  Vec2 mean(0);
  for (const Vec2& p : points) mean += Vec2(std::log(p.x), std::log(p.y)) / double(points.size());
  double xx = 0, xy = 0;
  for (const Vec2& p : points) {
    const Vec2 d = Vec2(std::log(p.x), std::log(p.y)) - mean;
    xx += d.x * d.x;
    xy += d.x * d.y;
  }
  return xy / xx;
}

std::string to_text(const Table& table) {
  const std::vector<std::size_t> widths = widths_of(table);
  std::string text = table.title + "\n";
  const auto add = [&](std::size_t column, const std::string& word, bool left) {
    const std::string padding(widths[column] - word.size(), ' ');
    if (column > 0) text += "  ";
    text += left ? word + padding : padding + word;
  };
  const auto is_word = [&](std::size_t column) {
    return !table.rows.empty() && std::holds_alternative<std::string>(table.rows.front()[column]);
  };
  for (std::size_t i = 0; i < widths.size(); ++i) add(i, table.columns[i].heading, is_word(i));
  text += '\n';
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < widths.size(); ++i) add(i, for_people(row[i]), is_word(i));
    text += '\n';
  }
  return text;
}

std::string to_csv(const Table& table) {
  std::string text;
  const auto add = [&](bool first, const std::string& word) {
    if (!first) text += ',';
    text += word;
  };
  for (std::size_t i = 0; i < table.columns.size(); ++i) add(i == 0, table.columns[i].key);
  text += '\n';
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) add(i == 0, for_machines(row[i]));
    text += '\n';
  }
  return text;
}

} // namespace domewarp::bench
