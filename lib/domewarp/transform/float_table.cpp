// SPDX-License-Identifier: Apache-2.0
#include "domewarp/transform/float_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "domewarp/transform/weight.h"

namespace domewarp {

namespace {

constexpr int most_nodes = FloatTable::most_powers;
constexpr double pi = std::numbers::pi;
constexpr double behind_from = 1.75; // radians: sin(theta) is still far from 0 there

// The half-angle index and its inverse.
struct Index {
  double alpha, scale;

  double u(double s, double c) const {
    const double a = 1 + std::abs(c), n = c < 0 ? a : s, o = c < 0 ? s : a;
    return n / (n + alpha * o);
  }
  Vec2 direction(double u_value) const {
    const double n = alpha * u_value, o = 1 - u_value, square = n * n + o * o;
    return {2 * n * o / square, (o - n) * (o + n) / square};
  }
  double theta_slope(double u_value) const {
    const double n = alpha * u_value, o = 1 - u_value;
    return 2 * alpha / (n * n + o * o);
  }
};

// A polynomial's coefficients, highest power first, and its nodes; the first are not used where the degree is lower.
using Piece = std::array<double, most_nodes>;

double evaluate(const Piece& piece, double x) {
  double value = 0;
  for (const double c : piece) value = value * x + c;
  return value;
}

double slope(const Piece& piece, double x) {
  double value = 0;
  for (int i = 0; i + 1 < most_nodes; ++i) value = value * x + (most_nodes - 1 - i) * piece[i];
  return value;
}

// Newton's divided differences, multiplied out.
Piece interpolate(const Piece& x, Piece y, int nodes) {
  for (int order = 1; order < nodes; ++order)
    for (int i = nodes - 1; i >= order; --i) y[i] = (y[i] - y[i - 1]) / (x[i] - x[i - order]);
  Piece lowest_first{};
  for (int i = nodes - 1; i >= 0; --i) {
    for (int power = nodes - 1; power > 0; --power) lowest_first[power] = lowest_first[power - 1] - x[i] * lowest_first[power];
    lowest_first[0] = y[i] - x[i] * lowest_first[0];
  }
  std::reverse(lowest_first.begin(), lowest_first.end());
  return lowest_first;
}

class Fitter {
public:
  Fitter(const Surface& surface, double alpha, int pieces, int degree, bool fine)
      : surface_(surface), branch_(surface.branches().front()), nodes_(degree + 1) {
    index_ = {alpha, 1};
    u_end_ = branch_.theta_high >= pi ? 1 : index_.u(std::sin(branch_.theta_high), std::cos(branch_.theta_high));
    fit_.table.pieces = pieces;
    fit_.table.degree = degree;
    fit_.table.fine = fine;
    fit_.table.alpha = static_cast<float>(alpha);
    fit_.table.scale = static_cast<float>(scale());
    index_.scale = fit_.table.scale;
    used_ = static_cast<int>(std::round(u_end_ * index_.scale)) + 1;
    last_ahead_ = std::round(index_.u(std::sin(behind_from), std::cos(behind_from)) * index_.scale);
  }

  /// False as soon as a piece is off by more than `allowed`.
  bool fit(double allowed) {
    double low = 0;
    for (int k = 0; k < used_; ++k) {
      const double high = radius_at_edge(k + 1);
      if (!fit_piece(k, low, high, allowed)) return false;
      low = high;
    }
    const double rounding = fit_.table.fine ? 3.6e-7 * branch_.radius_high : 1.2e-7 * condition_ + 3e-7 * branch_.radius_high;
    fit_.predicted_error = fit_.approximation + rounding;
    return fit_.predicted_error <= allowed;
  }

  FloatFit finish() {
    fit_weights();
    FloatTable& table = fit_.table;
    constexpr float never = std::numeric_limits<float>::infinity();
    table.last_ahead = static_cast<float>(last_ahead_);
    table.u_ahead = static_cast<float>((last_ahead_ + 0.5) / index_.scale);
    const double s = std::sin(branch_.theta_high), c = std::cos(branch_.theta_high);
    table.u_max = branch_.theta_high >= pi ? never : static_cast<float>(index_.u(s, c));
    extend(s, c);
    return fit_;
  }

private:
  // -1 to 1.
  double chebyshev_node(int i) const { return -std::cos(pi * (i + 0.5) / nodes_); }

  struct Sample {
    double x, k, s, radius, u; ///< k = R / s, s = sin(theta), or 1 far behind
  };

  // The rim is where the last piece ends, but for what rounding takes; a single kink falls on the edge of a piece.
  double scale() const {
    constexpr double rounding = 1e-4;
    const double even = (fit_.table.pieces - 0.5 - rounding) / u_end_;
    const std::vector<double>& joints = surface_.joints(0);
    if (joints.size() != 1) return even;
    const double kink = index_.u(std::sin(joints.front()), std::cos(joints.front()));
    for (double edge = std::floor(even * kink + 0.5) - 0.5; edge > 0; --edge) {
      const double end = u_end_ * edge / kink + 0.5;
      if (std::abs(end - std::round(end)) > rounding) return edge / kink;
    }
    return 0.5 / kink;
  }

  bool is_behind(int piece) const { return piece > last_ahead_; }

  double radius_at_edge(int edge) const {
    if (edge == used_) return branch_.radius_high;
    const Vec2 way = index_.direction((edge - 0.5) / index_.scale);
    return surface_.radius(0, way.x, way.y);
  }

  // Taken along the image radius, where it costs no root.
  Sample sample(int piece, double radius) const {
    const Vec2 way = *surface_.direction(std::min(radius, surface_.r_max())); // the end of a piece may round up
    const double u = index_.u(way.x, way.y);
    const double s = is_behind(piece) ? 1 : way.x;
    return {u * index_.scale - piece, radius / s, s, radius, u};
  }

  bool fit_piece(int piece, double low, double high, double allowed) {
    const auto at = [&](double x) { return sample(piece, low + 0.5 * (high - low) * (1 + x)); };
    std::array<Sample, most_nodes> samples;
    Piece x{}, y{};
    for (int i = 0; i < nodes_; ++i) {
      samples[i] = at(chebyshev_node(i));
      x[i] = samples[i].x;
      y[i] = samples[i].k;
      if (i > 0) condition_ = std::max(condition_, samples[i].u * (samples[i].radius - samples[i - 1].radius) / (samples[i].u - samples[i - 1].u));
    }
    pieces_.push_back(interpolate(x, y, nodes_));
    for (int power = 0; power < most_nodes; ++power) fit_.table.k[power][piece] = static_cast<float>(pieces_.back()[power] / index_.scale);
    for (int i = 0; i <= nodes_; ++i) {
      const double place = std::max(-std::cos(pi * i / nodes_), low == 0 ? -0.999 : -1.0); // K is 0/0 on the axis
      const Sample between = at(place);
      const double error = between.s * std::abs(evaluate(pieces_.back(), between.x) - between.k);
      if (!(error <= allowed)) return false; // not a number either
      fit_.approximation = std::max(fit_.approximation, error);
    }
    return true;
  }

  // dR / dtheta of the fitted piece.
  double radius_slope(int piece, double x) const {
    const double u = (piece + x) / index_.scale;
    const Vec2 way = index_.direction(u);
    const double k = evaluate(pieces_[piece], x), dk = slope(pieces_[piece], x) * index_.scale / index_.theta_slope(u);
    return is_behind(piece) ? dk : k * way.y + dk * way.x;
  }

  void fit_weights() {
    const double mean = mean_slope(surface_, 0);
    for (int k = 0; k < used_; ++k) {
      const double first = k == 0 ? 0 : -0.5, last = std::min(0.5, u_end_ * index_.scale - k);
      const auto place = [&](double x) { return first + 0.5 * (last - first) * (1 + x); };
      Piece x{}, y{};
      for (int i = 0; i < nodes_; ++i) {
        x[i] = place(chebyshev_node(i));
        y[i] = weight(radius_slope(k, x[i]), mean);
      }
      const Piece piece = interpolate(x, y, nodes_);
      for (int power = 0; power < most_nodes; ++power) fit_.table.g[power][k] = static_cast<float>(piece[power]);
      for (int i = 0; i <= nodes_; ++i) {
        const double between = place(-std::cos(pi * i / nodes_));
        fit_.weight_error = std::max(fit_.weight_error, std::abs(evaluate(piece, between) / weight(radius_slope(k, between), mean) - 1));
      }
    }
    fit_.table.g_beyond = static_cast<float>(weight(surface_.radial(0, branch_.theta_high).dr, mean));
  }

  // 1 / R sin = A cos + B sin on the tangent line, from the rim and one direction beyond it.
  void extend(double s, double c) {
    FloatTable& table = fit_.table;
    const double blind_from = surface_.blind().theta_low, middle = 0.5 * (branch_.theta_high + blind_from);
    const double s2 = std::sin(middle), c2 = std::cos(middle);
    const auto radius = surface_.extended_radius(Vec3(s2, 0, -c2));
    constexpr double narrow = 1e-6;
    if (!radius || blind_from - branch_.theta_high < narrow) {
      table.u_blind = table.u_max;
      return;
    }
    const double right = s / branch_.radius_high, right2 = s2 / *radius, determinant = c * s2 - c2 * s;
    table.beyond_z = static_cast<float>((right * s2 - right2 * s) / determinant);
    table.beyond_r = static_cast<float>((c * right2 - c2 * right) / determinant);
    table.u_blind = static_cast<float>(index_.u(std::sin(blind_from), std::cos(blind_from)));
  }

  const Surface& surface_;
  const Branch& branch_;
  Index index_{};
  FloatFit fit_;
  int nodes_;
  double u_end_ = 1, condition_ = 0, last_ahead_ = 0;
  int used_ = 0; ///< pieces up to the rim
  std::vector<Piece> pieces_;
};

} // namespace

std::optional<FloatFit> make_float_table(const Surface& surface, double max_error) {
  const auto& branches = surface.branches();
  const Branch& first = branches.front();
  if (branches.size() != 1 || first.theta_low != 0 || first.orientation < 0 || first.fold_high) return std::nullopt;
  constexpr double fine_weight = 2.5e-3, usable_weight = 0.05; // any smooth positive weight draws the same picture
  constexpr double aim = 0.2;             // of what is allowed: look no further
  constexpr struct {
    int pieces, degree;
  } sizes[] = {{8, 5}, {8, 7}, {16, 5}, {32, 5}}; // the faster first
  for (const auto [pieces, degree] : sizes)
    for (const double alpha : {1.0, 4.0, 0.5, 2.0, 16.0, 0.25}) {
      Fitter fitter(surface, alpha, pieces, degree, false);
      if (!fitter.fit(aim * max_error)) continue;
      const FloatFit fit = fitter.finish();
      if (fit.weight_error <= (pieces < FloatTable::most_pieces ? fine_weight : usable_weight)) return fit;
    }
  std::optional<FloatFit> best;
  for (const double alpha : {16.0, 4.0, 1.0, 64.0}) {
    Fitter fitter(surface, alpha, FloatTable::most_pieces, FloatTable::most_powers - 1, true);
    if (!fitter.fit(best ? best->predicted_error : max_error)) continue;
    const FloatFit fit = fitter.finish();
    if (fit.weight_error > usable_weight) continue;
    best = fit;
    if (best->predicted_error <= aim * max_error) return best;
  }
  return best;
}

} // namespace domewarp
