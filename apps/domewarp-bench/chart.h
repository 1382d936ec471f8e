// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "domewarp/core/vectors.h"

namespace domewarp::bench {

/// A word, or a number; a number that is not finite stands for "does not apply".
using Cell = std::variant<std::string, double>;

struct Column {
  std::string key;     ///< in CSV and JSON: may be added, never renamed
  std::string heading; ///< for people, with the unit
};

struct Table {
  std::string name;  ///< file stem and JSON key
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows; ///< each as long as `columns`
};

struct Axis {
  std::string label; ///< with the unit
  bool log = false;
  std::vector<std::string> categories{}; ///< names of 0, 1, 2, ... where the axis counts things rather than measures
};

struct Series {
  std::string name;
  std::vector<Vec2> points; ///< points that are not finite, or not positive on a log axis, are left out
  bool line = true;         ///< false: markers only
};

/// A line or scatter plot.
struct Plot {
  std::string name; ///< file stem
  std::string title;
  Axis x, y;
  std::vector<Series> series;
};

std::string three_digits(double value);

/// Slope of the least-squares line through (log x, log y): 1 is linear growth.
double log_log_slope(const std::vector<Vec2>& points);

/// Aligned columns under the title, numbers with four significant digits.
std::string to_text(const Table& table);
/// A line of keys, then a line per row; numbers round trip.
std::string to_csv(const Table& table);
/// Series differ in colour, dash and marker, so that they stay apart in black and white.
/// @param footer a line below the plot: the machine
std::string to_svg(const Plot& plot, const std::string& footer);

} // namespace domewarp::bench
