// SPDX-License-Identifier: Apache-2.0
//
// Based on: Fritsch and Butland, "A method for constructing local monotone piecewise cubic interpolants" (1984): slopes
// are weighted harmonic means of the neighbouring secants, 0 where these differ in sign.
#include "domewarp/profile/measured.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/profile/refuse.h"

namespace domewarp {

namespace {

constexpr std::size_t row_limit = 65536;

[[noreturn]] void refuse_line(const std::filesystem::path& path, std::size_t line, const std::string& what) {
  throw Error(ErrorCode::input, path.string() + ": line " + std::to_string(line) + ": " + what);
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Takes one number off the front; false when there is none.
bool take_number(std::string_view& text, double& value) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool take_separator(std::string_view& text) {
  const std::size_t length = std::min(text.find_first_not_of(" \t,;"), text.size());
  text.remove_prefix(length);
  return length > 0;
}

bool parse_row(std::string_view text, Vec2& row) {
  return take_number(text, row.x) && take_separator(text) && take_number(text, row.y) && text.empty();
}

// What keeps `row` from following `rows`; empty when nothing does.
std::string objection(const std::vector<Vec2>& rows, const Vec2& row) {
  if (!std::isfinite(row.x) || !std::isfinite(row.y))
    return "r and z must be finite, got " + to_text(row.x) + " " + to_text(row.y);
  if (rows.empty()) return row.x == 0 ? "" : "the first row must be at r = 0, got " + to_text(row.x);
  if (row.x == rows.back().x) return "r = " + to_text(row.x) + " appears twice";
  if (row.x < rows.back().x) return "r must increase, got " + to_text(row.x) + " after " + to_text(rows.back().x);
  if (rows.size() >= row_limit) return "more than " + std::to_string(row_limit) + " rows";
  return "";
}

MeasuredCurve check_rows(const std::vector<Vec2>& rows, const std::string& name) {
  MeasuredCurve curve;
  std::vector<Vec2> before;
  for (const Vec2& row : rows) {
    if (const std::string what = objection(before, row); !what.empty()) refuse("--profile", name + ": " + what);
    before = {row};
    curve.r.push_back(row.x);
    curve.z.push_back(row.y);
  }
  if (rows.size() >= 2 && rows.size() <= row_limit) return curve;
  refuse("--profile",
         name + ": a profile needs 2 to " + std::to_string(row_limit) + " rows, got " + std::to_string(rows.size()));
}

// Three-point slope at an end, kept from overshooting.
double end_slope(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0) return 0;
  if (d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0)) return 3 * d0;
  return slope;
}

double inner_slope(double h0, double h1, double d0, double d1) {
  if (d0 * d1 <= 0) return 0;
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

std::size_t piece_at(const MeasuredCurve& curve, double r) {
  const auto next = std::upper_bound(curve.r.begin(), curve.r.end() - 1, r);
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - curve.r.begin() - 1, 0));
}

// z + s t + a t^2 + b t^3 with t = r - knot.
template <typename T>
Jet<T> evaluate_piece(const MeasuredCurve& curve, std::size_t i, const T& r) {
  const double h = curve.r[i + 1] - curve.r[i], secant = (curve.z[i + 1] - curve.z[i]) / h;
  const double s = curve.slope[i];
  const double a = (3 * secant - 2 * s - curve.slope[i + 1]) / h;
  const double b = (s + curve.slope[i + 1] - 2 * secant) / (h * h);
  const T t = r - T(curve.r[i]);
  return {T(curve.z[i]) + t * (T(s) + t * (T(a) + t * T(b))), T(s) + t * (T(2 * a) + t * T(3 * b)),
          T(2 * a) + t * T(6 * b)};
}

} // namespace

std::vector<Vec2> read_profile(const std::filesystem::path& path) {
  const std::vector<std::uint8_t> bytes = read_file(path);
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<Vec2> rows;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view text = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (text.empty() || text.front() == '#') continue;
    Vec2 row;
    if (!parse_row(text, row)) refuse_line(path, line, "expected two numbers, r and z");
    if (const std::string what = objection(rows, row); !what.empty()) refuse_line(path, line, what);
    rows.push_back(row);
  }
  if (rows.size() >= 2) return rows;
  throw Error(ErrorCode::input,
              path.string() + ": a profile needs at least two rows, found " + std::to_string(rows.size()));
}

MeasuredCurve fit_measured(const std::vector<Vec2>& rows, const std::string& name) {
  MeasuredCurve curve = check_rows(rows, name);
  const std::size_t count = rows.size();
  std::vector<double> h(count - 1), d(count - 1);
  for (std::size_t i = 0; i + 1 < count; ++i) {
    h[i] = curve.r[i + 1] - curve.r[i];
    d[i] = (curve.z[i + 1] - curve.z[i]) / h[i];
    if (!std::isfinite(d[i])) refuse("--profile", name + ": too steep at r = " + to_text(curve.r[i]));
  }
  curve.slope.assign(count, d[0]);
  if (count == 2) return curve;
  for (std::size_t i = 1; i + 1 < count; ++i) curve.slope[i] = inner_slope(h[i - 1], h[i], d[i - 1], d[i]);
  curve.slope.front() = end_slope(h[0], h[1], d[0], d[1]);
  curve.slope.back() = end_slope(h[count - 2], h[count - 3], d[count - 2], d[count - 3]);
  return curve;
}

namespace {

template <typename T>
Jet<T> evaluate_inside(const MeasuredCurve& curve, const T& r) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (!(r >= curve.r.front() && r <= curve.r.back())) return {nan, nan, nan};
  return evaluate_piece(curve, piece_at(curve, static_cast<double>(r)), r);
}

} // namespace

double evaluate(const MeasuredCurve& curve, double r) { return differentiate(curve, r).v; }

Jet<double> differentiate(const MeasuredCurve& curve, double r) { return evaluate_inside(curve, r); }

Jet<Quad> differentiate(const MeasuredCurve& curve, const Quad& r) { return evaluate_inside(curve, r); }

Jet<Interval> enclose_jet(const MeasuredCurve& curve, const Interval& cell) {
  if (cell.lo < curve.r.front() || cell.hi > curve.r.back()) {
    const Interval unknown = entire(Regularity::unknown);
    return {unknown, unknown, unknown};
  }
  // The middle tells the piece even when the cell starts at a knot.
  return evaluate_piece(curve, piece_at(curve, 0.5 * (cell.lo + cell.hi)), cell);
}

} // namespace domewarp
