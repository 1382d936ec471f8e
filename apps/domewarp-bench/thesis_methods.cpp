// SPDX-License-Identifier: Apache-2.0
// Based on: the founding thesis, sections 3.2 and 3.4. What it leaves undefined (the axis, directions behind r_max) ends
// at the nearest value the method has.
#include "thesis_methods.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace domewarp::bench {

namespace {

constexpr double step = 0.05 * std::numbers::pi / 180;
constexpr double accuracy = 1e-6;

double bisect(const Curve& curve, double r_max, double slope) {
  double low = 0, high = r_max;
  while (high - low > accuracy) {
    const double middle = 0.5 * (low + high);
    (evaluate(curve, middle) > slope * middle ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

template <typename Radius>
void map_all(const ConstPoints& in, const Points& out, std::size_t count, const Radius& radius) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = i * in.stride, to = i * out.stride;
    const float x = in.x[from], y = in.y[from], z = -in.z[from], r = std::sqrt(x * x + y * y);
    const float scale = radius(z / r) / r;
    out.x[to] = x * scale;
    out.y[to] = y * scale;
    out.z[to] = std::sqrt(r * r + z * z);
  }
}

} // namespace

void map_by_bisection(const Curve& curve, double r_max, const ConstPoints& in, const Points& out, std::size_t count) {
  map_all(in, out, count, [&](float slope) { return static_cast<float>(bisect(curve, r_max, slope)); });
}

ThesisTable make_thesis_table(const Curve& curve, double r_max) {
  ThesisTable table;
  const int last = static_cast<int>(std::lround(std::numbers::pi / step));
  for (int i = 0; i <= last; ++i)
    table.radii.push_back(static_cast<float>(bisect(curve, r_max, std::tan(i * step - 0.5 * std::numbers::pi))));
  return table;
}

void map_by_thesis_table(const ThesisTable& table, const ConstPoints& in, const Points& out, std::size_t count) {
  constexpr float quarter = static_cast<float>(0.5 * std::numbers::pi), per_step = static_cast<float>(1 / step), half = 0.5F;
  const std::size_t last = table.radii.size() - 1;
  map_all(in, out, count, [&](float slope) {
    const auto index = static_cast<std::size_t>((std::atan(slope) + quarter) * per_step + half);
    return table.radii[std::min(index, last)];
  });
}

} // namespace domewarp::bench
