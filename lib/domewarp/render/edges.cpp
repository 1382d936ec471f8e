// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/edges.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/core/quantile.h"
#include "domewarp/render/shading.h"

namespace domewarp {

namespace {

constexpr double least_step = 0.05; ///< of luminance between the sides of an edge
constexpr double most_change = 0.02; ///< of luminance along a side, relative to the step
constexpr int widest = 48;           ///< profile to each side, px

struct Luminance {
  int width, height;
  std::vector<float> values;

  double at(int column, int row) const { return values[std::size_t(row) * std::size_t(width) + std::size_t(column)]; }
};

Luminance luminance_of(const Pixels& pixels) {
  Luminance result{pixels.width, pixels.height, std::vector<float>(pixels.rgba.size() / 4)};
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    const std::uint8_t* p = &pixels.rgba[4 * i];
    result.values[i] = static_cast<float>(luminance({linear_of_srgb(p[0]), linear_of_srgb(p[1]), linear_of_srgb(p[2])}) * p[3] / 255.0);
  }
  return result;
}

/// How the source pixel changes per pixel to the right and down, as columns.
std::optional<glm::dmat2> source_slope(const SourcePixel& source, const Vec2& at) {
  const auto left = source(at - Vec2(0.5, 0)), right = source(at + Vec2(0.5, 0));
  const auto above = source(at - Vec2(0, 0.5)), below = source(at + Vec2(0, 0.5));
  if (!left || !right || !above || !below) return std::nullopt;
  const glm::dmat2 slope(*right - *left, *below - *above);
  if (!(std::abs(glm::determinant(slope)) > 1e-12)) return std::nullopt;
  return slope;
}

/// One place at an edge: `normal` . (shift of the source picture) = `distance`, both in source pixels.
struct Measured {
  Vec2 normal;
  double distance, view_px;
};

struct Pair {
  const Luminance& picture;
  const Luminance& reference;
  const SourcePixel& source;
};

/// Values along a row (axis 0) or column through a pixel.
struct Scan {
  const Luminance& light;
  int column, row, axis;

  double operator[](int offset) const {
    return axis == 0 ? light.at(column + offset, row) : light.at(column, row + offset);
  }
};

Vec2 gradient(const Luminance& l, int x, int y) {
  Vec2 sum(0);
  for (int k = -1; k <= 1; ++k) {
    const double weight = k == 0 ? 2 : 1;
    sum.x += weight * (l.at(x + 1, y + k) - l.at(x - 1, y + k));
    sum.y += weight * (l.at(x + k, y + 1) - l.at(x + k, y - 1));
  }
  return sum;
}

/// Whether both sides of a step are even between 2 px and `reach` from it.
bool is_isolated(const Scan& scan, double step, int reach) {
  for (const int side : {-1, 1})
    for (int i = 3; i <= reach; ++i)
      if (std::abs(scan[side * i] - scan[side * 2]) > most_change * std::abs(step)) return false;
  return true;
}

std::optional<Measured> measure(const Pair& pair, int column, int row, int axis) {
  const int along = axis == 0 ? column : row, length = axis == 0 ? pair.reference.width : pair.reference.height;
  if (along < 4 || along + 4 >= length) return std::nullopt;
  const Scan reference{pair.reference, column, row, axis}, picture{pair.picture, column, row, axis};
  const double slope = reference[1] - reference[-1], step = reference[2] - reference[-2];
  if (std::abs(step) < least_step) return std::nullopt;
  if (std::abs(slope) < std::abs(reference[2] - reference[0]) || std::abs(slope) <= std::abs(reference[0] - reference[-2])) return std::nullopt;
  const Vec2 across = gradient(pair.reference, column, row);
  if (std::abs(across[axis]) < std::abs(across[1 - axis])) return std::nullopt;
  const auto jacobian = source_slope(pair.source, {column + 0.5, row + 0.5});
  if (!jacobian) return std::nullopt;
  const glm::dmat2 view_of_source = glm::inverse(*jacobian);
  const double footprint = std::max(glm::length(view_of_source[0]), glm::length(view_of_source[1]));
  const int reach = 3 + static_cast<int>(std::ceil(2 * footprint)), far = reach + static_cast<int>(std::ceil(1.5 * footprint));
  if (far > widest || along < far || along + far >= length || !is_isolated(reference, step, far)) return std::nullopt;
  const Vec2 here(column + 0.5, row + 0.5), end = axis == 0 ? Vec2(far, 0) : Vec2(0, far);
  if (!pair.source(here - end) || !pair.source(here + end)) return std::nullopt; // the source picture ends before the profile
  double area = 0;
  for (int i = -reach; i <= reach; ++i) area += reference[i] - picture[i];
  const double moved = area / step;
  const Vec2 unit = glm::normalize(across);
  const Vec2 normal = glm::transpose(view_of_source) * unit / unit[axis];
  const double size = glm::length(normal);
  return Measured{normal / size, moved / size, moved};
}

/// Least squares for normal . bias = distance.
Vec2 fit_bias(const std::vector<Measured>& all) {
  glm::dmat2 sums(0);
  Vec2 right(0);
  for (const Measured& m : all) {
    sums += glm::dmat2(m.normal * m.normal.x, m.normal * m.normal.y);
    right += m.normal * m.distance;
  }
  return std::abs(glm::determinant(sums)) > 1e-9 ? glm::inverse(sums) * right : Vec2(0);
}

} // namespace

EdgeReport compare_edges(const Pixels& picture, const Pixels& reference, const SourcePixel& source) {
  if (picture.width != reference.width || picture.height != reference.height)
    throw Error(ErrorCode::usage, "edges: the two pictures differ in size");
  const Luminance a = luminance_of(picture), b = luminance_of(reference);
  const Pair pair{a, b, source};
  std::vector<std::vector<Measured>> by_row(std::size_t(reference.height));
  parallel_each(by_row.size(), 8, [&](std::size_t line) {
    const int row = static_cast<int>(line);
    if (row == 0 || row == reference.height - 1) return;
    for (int column = 1; column + 1 < reference.width; ++column)
      for (const int axis : {0, 1})
        if (const auto measured = measure(pair, column, row, axis)) by_row[line].push_back(*measured);
  });
  std::vector<Measured> all;
  for (const auto& row : by_row) all.insert(all.end(), row.begin(), row.end());
  EdgeReport report;
  report.count = all.size();
  if (all.empty()) return report;
  std::vector<double> distances, in_view;
  for (const Measured& m : all) {
    distances.push_back(std::abs(m.distance));
    in_view.push_back(std::abs(m.view_px));
    report.within_pixel += std::abs(m.distance) <= 1;
  }
  report.within_pixel /= double(all.size());
  report.median = quantile(distances, 2);
  report.p99 = quantile(distances, 100);
  report.median_view_px = quantile(in_view, 2);
  report.bias = fit_bias(all);
  return report;
}

} // namespace domewarp
