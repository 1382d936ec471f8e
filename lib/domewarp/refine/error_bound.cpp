// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/error_bound.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/refine/visible_region.h"

namespace domewarp {

double EdgeBound::error(int n) const {
  const double bend = std::min(weight_bend / (n * n), weight_slope / n);
  return second_order / (n * n) + (image_change / n) * bend;
}

namespace {

/// The quantities at one angle, in the order of ErrorBound::Quantity.
std::array<double, 7> quantities_at(const RadialJet& jet, const Vec3& weight, double theta) {
  const double s = std::sin(theta), c = std::cos(theta);
  const double g = weight.x, g1 = weight.y, g2 = weight.z;
  const double factor = jet.r / s;
  const double across = (jet.dr * s * c - jet.r) / (s * s);
  const double mixed = (jet.dr * s - jet.r * c) / (s * s);
  return {std::abs(g * jet.d2r + 2 * g1 * jet.dr), std::abs(g * across),
          std::abs(g * mixed + g1 * factor),       std::abs(jet.dr),
          std::abs(factor),                        std::max(std::abs(g + g2), std::abs(g + g1 * c / s)),
          std::hypot(g, g1)};
}

} // namespace

ErrorBound::ErrorBound(const Surface& surface, std::size_t branch, const BranchMap& map, Projection projection)
    : projection_(projection), theta_low_(map.branch().theta_low), theta_high_(map.branch().theta_high) {
  // Eight samples a cell and a margin of the largest difference between neighbours stand for the supremum.
  constexpr int samples = 8;
  constexpr double smallest_angle = 1e-4; // below it the quotients cancel; their limits differ by O(1e-4)
  std::vector<Row> base(cells);
  const double step = (theta_high_ - theta_low_) / cells;
  for (int i = 0; i < cells; ++i) {
    Row low{}, high{};
    for (int k = 0; k <= samples; ++k) {
      const double theta = std::clamp(theta_low_ + (i + static_cast<double>(k) / samples) * step, smallest_angle, 3.14159);
      const Vec3 weight = projection == Projection::perspective ? map.weight_jet(theta) : Vec3(1, 0, 0);
      const Row row = quantities_at(surface.radial(branch, theta), weight, theta);
      for (int q = 0; q < quantities; ++q) {
        low[q] = k == 0 ? row[q] : std::min(low[q], row[q]);
        high[q] = k == 0 ? row[q] : std::max(high[q], row[q]);
      }
    }
    for (int q = 0; q < quantities; ++q) base[i][q] = high[q] + (high[q] - low[q]) / samples;
  }
  levels_.push_back(std::move(base));
  for (std::size_t width = 2; width <= cells; width *= 2) {
    const std::vector<Row>& finer = levels_.back();
    std::vector<Row> level(cells - width + 1);
    for (std::size_t i = 0; i < level.size(); ++i)
      for (int q = 0; q < quantities; ++q) level[i][q] = std::max(finer[i][q], finer[i + width / 2][q]);
    levels_.push_back(std::move(level));
  }
}

ErrorBound::Row ErrorBound::supremum(double theta_low, double theta_high) const {
  const double scale = cells / (theta_high_ - theta_low_);
  const auto cell = [&](double theta) {
    return static_cast<std::size_t>(std::clamp((theta - theta_low_) * scale, 0.0, cells - 1.0));
  };
  const std::size_t first = cell(theta_low), last = cell(theta_high);
  const std::size_t level = std::bit_width(last - first + 1) - 1;
  const Row& left = levels_[level][first];
  const Row& right = levels_[level][last + 1 - (std::size_t{1} << level)];
  Row row;
  for (int q = 0; q < quantities; ++q) row[q] = std::max(left[q], right[q]);
  return row;
}

namespace {

struct Angles {
  double low, high;
};

/// Range of theta on the segment: its ends, and the only interior extremum if there is one.
Angles angle_range(const Vec3& a, const Vec3& b) {
  const auto theta = [](const Vec3& p) { return std::atan2(std::hypot(p.x, p.y), -p.z); };
  auto [low, high] = std::minmax({theta(a), theta(b)});
  if (const std::optional<double> t = extremum(Boundary{Boundary::Kind::high_cone}, a, b)) {
    const double middle = theta(a + *t * (b - a));
    low = std::min(low, middle);
    high = std::max(high, middle);
  }
  return {low, high};
}

/// Range of sin^2 of the heading against the meridian, by Clairaut: sin(chi) = |n_z| / sin(theta).
Angles heading_range(const Vec3& normal, double normal_length, double scale, const Angles& theta) {
  if (!(normal_length > 1e-12 * scale)) return {0, 1};
  const double nz2 = (normal.z / normal_length) * (normal.z / normal_length);
  const double sin_low = std::sin(theta.low), sin_high = std::sin(theta.high);
  const double smallest = std::min(sin_low, sin_high);
  const double largest = theta.low < 1.5707963267948966 && theta.high > 1.5707963267948966 ? 1 : std::max(sin_low, sin_high);
  return {std::min(1.0, nz2 / (largest * largest) * (1 - 1e-9)), std::min(1.0, nz2 / (smallest * smallest) * (1 + 1e-9))};
}

double largest_sin_2chi(const Angles& sin2) {
  if (sin2.low <= 0.5 && sin2.high >= 0.5) return 1;
  const double s = sin2.high < 0.5 ? sin2.high : sin2.low;
  return 2 * std::sqrt(s * (1 - s));
}

} // namespace

EdgeBound ErrorBound::edge(const Vec3& a, const Vec3& b, double wa, double wb) const {
  const Vec3 d = b - a, normal = glm::cross(a, b);
  const double length2 = glm::dot(d, d), length = std::sqrt(length2);
  const double rho_a = glm::length(a), rho_b = glm::length(b);
  const double area = glm::length(normal);
  const double h = area / length;
  const double s_a = glm::dot(a, d) / length, s_b = glm::dot(b, d) / length; // from the foot of the perpendicular
  const bool foot_inside = s_a < 0 && s_b > 0;
  const double rho_min = foot_inside ? h : std::min(rho_a, rho_b);
  const Angles theta = angle_range(a, b);
  const Angles sin2 = heading_range(normal, area, rho_a * rho_b, theta);
  const Row sup = supremum(theta.low, theta.high);

  const auto blend = [](double along, double across, double s2) { return along * (1 - s2) + across * s2; };
  const double radial = std::max(blend(sup[radial_second], sup[cross_second], sin2.low),
                                 blend(sup[radial_second], sup[cross_second], sin2.high));
  const double second = std::hypot(radial, sup[mixed_second] * largest_sin_2chi(sin2));
  const double r2 = sup[slope] * sup[slope], k2 = sup[factor] * sup[factor];
  const double speed = std::sqrt(std::max(blend(r2, k2, sin2.low), blend(r2, k2, sin2.high)));
  const double angle = std::atan2(area, glm::dot(a, b));

  EdgeBound bound;
  const double bend = length2 / 8 * (h * h) / (rho_min * rho_min * rho_min);
  bound.depth = bend / rho_min;
  if (projection_ == Projection::perspective) {
    const double w_min = std::min(wa, wb);
    bound.second_order = bend * second / w_min;
    bound.image_change = speed * angle;
    bound.weight_bend = bend * sup[weight_curvature] / w_min;
    bound.weight_slope = 0.5 * length * sup[weight_gradient] / w_min;
    bound.depth = std::min(bound.weight_bend, bound.weight_slope);
    return bound;
  }
  const double peak = h / std::sqrt(3.0); // where h |s| / rho^4 is largest
  const auto speed_change = [&](double s) { return h * std::abs(s) / ((h * h + s * s) * (h * h + s * s)); };
  double change = std::max(speed_change(s_a), speed_change(s_b));
  if ((s_a < peak && peak < s_b) || (s_a < -peak && -peak < s_b)) change = 3 * std::sqrt(3.0) / (16 * h * h);
  bound.second_order = bend / rho_min * second + length2 / 4 * change * speed;
  return bound;
}

} // namespace domewarp
