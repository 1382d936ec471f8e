// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <tuple>

#include "domewarp/transform/continuation.h"
#include "domewarp/transform/image_map.h"
#include "domewarp/transform/polar.h"
#include "domewarp/transform/radial_table.h"
#include "domewarp/transform/weight.h"

namespace domewarp {

namespace {

// sin(theta) below which K has reached its value on the axis.
constexpr double smallest_sine = 1e-150;

constexpr double rounding = 1e-15; // of a half-angle index

} // namespace

namespace {

// A direction at exactly 90 degrees belongs to a lens of 180, though the cosine of the nearest double is 6e-17.
Vec2 sine_and_cosine(double theta) { return {std::sin(theta), theta == std::numbers::pi / 2 ? 0 : std::cos(theta)}; }

} // namespace

struct BranchMap::Impl {
  Surface surface;
  std::size_t index;
  Branch branch; ///< of the surface
  Branch drawn;
  Continuation before, after;
  double mean = 1;
  RadialTable table{};
  TableReport report{};
  Vec2 low{0, 1}, high{0, -1}; // sine and cosine of the ends of what is drawn
  double u_low = 0, u_high = 1;
  double least = 0, most = 0; // image radius
  double g_low = 1, g_high = 1; // at the ends, for what lies beyond

  void tabulate() {
    const auto start = std::chrono::steady_clock::now();
    table = make_radial_table(surface, index);
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    const TableReason reason = table.qualifies ? TableReason::used : TableReason::inexact;
    report = {table.qualifies, reason, static_cast<int>(table.pieces.size()), RadialTable::degree, table.max_error, elapsed.count()};
    if (!table.qualifies) table = {};
  }

  void find_ends() {
    std::tie(least, most) = std::minmax(branch.radius_low, branch.radius_high);
    low = sine_and_cosine(drawn.theta_low);
    high = sine_and_cosine(drawn.theta_high);
    const Vec2 first = sine_and_cosine(branch.theta_low), last = sine_and_cosine(branch.theta_high);
    u_low = branch.theta_low == 0 ? 0 : half_angle_index(first.x, first.y, 1);
    u_high = branch.theta_high >= std::numbers::pi ? 1 : half_angle_index(last.x, last.y, 1);
    g_low = weight(surface.radial(index, branch.theta_low).dr, mean);
    g_high = weight(surface.radial(index, branch.theta_high).dr, mean);
  }

  static RadialFactors beyond(const Continuation& continuation, const Polar& p, double g) {
    const double sine = p.r / p.rho;
    return {continuation.radius(sine, p.z / p.rho) / std::max(sine, smallest_sine), g};
  }

  /// R of a direction within the branch.
  double radius(const Polar& p, double u) const {
    if (!report.used) return direct_radius(p);
    const TableValue value = look_up(table, u);
    return value.fine ? std::clamp(value.ratio * u, least, most) : direct_radius(p);
  }

  // R and g of a direction within the branch.
  struct Values {
    double radius, g;
  };

  double direct_radius(const Polar& p) const {
    if (p.r < smallest_sine * p.rho) return surface.radius(index, smallest_sine, p.z / p.rho);
    return surface.radius(index, Vec3(p.x, p.y, -p.z));
  }

  Values values(const Polar& p, double u) const {
    if (!report.used) {
      const RadialJet jet = surface.radial(index, Vec3(p.x, p.y, -p.z));
      return {p.r < smallest_sine * p.rho ? direct_radius(p) : jet.r, weight(jet.dr, mean)};
    }
    const TableValue value = look_up(table, u);
    return {value.fine ? std::clamp(value.ratio * u, least, most) : direct_radius(p), value.g};
  }

  // Directions that rounding cannot tell from an end get values of their own: beside a fold R moves by much more.
  bool is_below(double u) const { return u < u_low - rounding; }
  bool is_above(double u) const { return u > u_high + rounding; }
};

BranchMap::BranchMap(const Surface& surface, std::size_t branch, Method method, std::size_t points) {
  const Branch& range = surface.branches()[branch];
  auto impl = std::make_unique<Impl>(Impl{surface, branch, range, drawn_branch(surface, branch), {surface, branch, false}, {surface, branch, true}, mean_slope(surface, branch)});
  const bool few = method == Method::automatic && points < table_pays_from;
  if (few) impl->report.reason = TableReason::few_points;
  if (method != Method::direct && !few) impl->tabulate();
  impl->find_ends();
  impl_ = std::move(impl);
}

const char* to_string(TableReason reason) {
  switch (reason) {
  case TableReason::used: return "a table is within 1e-10 image units";
  case TableReason::direct_asked: return "the direct method was asked for";
  case TableReason::few_points: return "fewer points than a table pays for";
  default: return "no table is within 1e-10 image units";
  }
}

BranchMap::~BranchMap() = default;
BranchMap::BranchMap(BranchMap&&) noexcept = default;
BranchMap& BranchMap::operator=(BranchMap&&) noexcept = default;

const Branch& BranchMap::branch() const { return impl_->drawn; }

double BranchMap::end_slope(bool is_high) const {
  const Branch& drawn = impl_->drawn;
  if (is_high ? drawn.fold_high : drawn.fold_low) return 0;
  return (is_high ? impl_->after : impl_->before).slope(is_high ? drawn.theta_high : drawn.theta_low);
}
const TableReport& BranchMap::table() const { return impl_->report; }

RadialFactors BranchMap::factors(const Vec3& p) const {
  const Polar q = polar(p);
  const double u = half_angle_index(q.r, q.z, q.rho);
  if (impl_->is_below(u)) return Impl::beyond(impl_->before, q, impl_->g_low);
  if (impl_->is_above(u)) return Impl::beyond(impl_->after, q, impl_->g_high);
  if (impl_->report.used && q.z >= 0) {
    // K = (R / u) (u / s) without a division by r.
    const TableValue value = look_up(impl_->table, u);
    const double radius = value.ratio * u;
    const bool within = radius >= impl_->least && radius <= impl_->most;
    if (value.fine && within) return {value.ratio * (q.rho / (q.r + q.rho + q.z)), value.g};
  }
  const auto [radius, g] = impl_->values(q, u);
  return {radius / std::max(q.r / q.rho, smallest_sine), g};
}

Vec2 BranchMap::image(const Vec3& p) const {
  const Polar q = polar(p);
  const double u = half_angle_index(q.r, q.z, q.rho);
  const bool inside = !impl_->is_below(u) && !impl_->is_above(u);
  const bool directly = !impl_->report.used && q.r >= smallest_sine * q.rho; // K would take the weight along
  if (inside && (q.z < 0 || directly)) {
    // K has no bound on the backward axis, which is a circle in the image; its point on the x axis stands for it.
    return (q.r > 0 ? impl_->radius(q, u) : impl_->branch.radius_high) * side(q);
  }
  const double scale = factors(p).k / q.rho;
  return {q.x * scale, q.y * scale};
}

Vec2 BranchMap::inside(const Vec3& p) const {
  const Polar q = polar(p);
  const Vec2 low = impl_->low, high = impl_->high;
  return q.unit * Vec2(impl_->drawn.theta_low == 0 ? q.rho : q.r * low.y - q.z * low.x,
                       impl_->drawn.theta_high >= std::numbers::pi ? q.rho : q.z * high.x - q.r * high.y);
}

Vec3 BranchMap::weight_jet(double theta) const { return domewarp::weight_jet(impl_->surface, impl_->index, theta); }

} // namespace domewarp
