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
constexpr double behind_from = 2.6; // radians: sin(theta) is still far from 0 there

using Reach = FloatTable::Reach;

constexpr double cosine_share = 0.6; // fewer roundings

// The index and its inverse.
struct Index {
  bool is_cosine;
  double alpha;
  double scale = 1; // steps

  double u(double s, double c) const {
    if (is_cosine) return 0.5 * (1 - c);
    const double a = 1 + std::abs(c), n = c < 0 ? a : s, o = c < 0 ? s : a;
    return n / (n + alpha * o);
  }
  Vec2 direction(double u_value) const {
    if (is_cosine) return {2 * std::sqrt(u_value * (1 - u_value)), 1 - 2 * u_value};
    const double n = alpha * u_value, o = 1 - u_value, square = n * n + o * o;
    return {2 * n * o / square, (o - n) * (o + n) / square};
  }
  double slope(double u_value) const { // du / dtheta
    if (is_cosine) return std::sqrt(u_value * (1 - u_value));
    const double n = alpha * u_value, o = 1 - u_value;
    return 0.5 * (n * n + o * o) / alpha;
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

// What a table may be like.
struct Shape {
  Reach reach;
  double alpha;
  int pieces, degree;
  bool fine = false;
};

class Fitter {
public:
  Fitter(const Surface& surface, const Shape& shape)
      : surface_(surface), branch_(surface.branches().front()), nodes_(shape.degree + 1) {
    const bool is_cosine = shape.reach == Reach::cosine;
    index_ = {is_cosine, shape.alpha};
    u_end_ = branch_.theta_high >= pi ? 1 : index_.u(std::sin(branch_.theta_high), std::cos(branch_.theta_high));
    FloatTable& table = fit_.table;
    table.pieces = shape.pieces;
    table.degree = shape.degree;
    table.fine = shape.fine;
    table.reach = shape.reach;
    table.alpha = static_cast<float>(shape.alpha);
    table.scale = static_cast<float>(is_cosine ? 0.5 * scale() : scale());
    index_.scale = is_cosine ? 2.0 * table.scale : table.scale;
    used_ = static_cast<int>(std::round(u_end_ * index_.scale)) + 1;
    last_ahead_ = std::round(index_.u(std::sin(behind_from), std::cos(behind_from)) * index_.scale);
  }

  /// False as soon as a piece is off by more than `allowed`.
  bool fit(double allowed) {
    condition_ = condition_at_rim();
    if (!(rounding() <= allowed)) return false;
    double low = 0;
    for (int k = 0; k < used_; ++k) {
      const double high = radius_at_edge(k + 1);
      if (!fit_piece(k, low, high, allowed)) return false;
      low = high;
    }
    fit_.predicted_error = fit_.approximation + rounding();
    return fit_.predicted_error <= allowed;
  }

  FloatFit finish() {
    fit_weights();
    FloatTable& table = fit_.table;
    constexpr float never = std::numeric_limits<float>::infinity();
    table.last_ahead = static_cast<float>(last_ahead_);
    const double s = std::sin(branch_.theta_high), c = std::cos(branch_.theta_high);
    table.u_max = branch_.theta_high >= pi ? never : edge(s, c);
    extend(s, c);
    return fit_;
  }

private:
  // What the kernel compares with.
  float edge(double s, double c) const { return static_cast<float>(index_.is_cosine ? -c : index_.u(s, c)); }

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

  bool is_behind(int piece) const { return fit_.table.reach == Reach::behind && piece > last_ahead_; }

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

  double rounding() const {
    // What holds without fused operations too.
    return fit_.table.fine ? 3.6e-7 * branch_.radius_high : 1.2e-7 * condition_ + 3.4e-7 * branch_.radius_high;
  }

  // By what single precision's rounding of the index is multiplied.
  double condition(const Sample& a, const Sample& b) const {
    if (index_.is_cosine) return cosine_share * b.s * std::abs((b.k - a.k) / (b.u - a.u));
    return b.u * (b.radius - a.radius) / (b.u - a.u);
  }

  // Where it is greatest as a rule.
  double condition_at_rim() const {
    const double s = std::sin(branch_.theta_high), c = std::cos(branch_.theta_high);
    const RadialJet jet = surface_.radial(0, branch_.theta_high);
    if (index_.is_cosine) return cosine_share * 2 * std::abs(jet.dr * s - jet.r * c) / (s * s);
    return branch_.theta_high < pi ? u_end_ * jet.dr / index_.slope(u_end_) : 0;
  }

  bool fit_piece(int piece, double low, double high, double allowed) {
    const auto at = [&](double x) {
      const double part = 0.5 * (1 + x);
      // R grows with the root of 1 - cos(theta)
      return sample(piece, index_.is_cosine ? std::sqrt(low * low + (high * high - low * low) * part) : low + (high - low) * part);
    };
    std::array<Sample, most_nodes> samples;
    Piece x{}, y{};
    for (int i = 0; i < nodes_; ++i) {
      samples[i] = at(chebyshev_node(i));
      x[i] = samples[i].x;
      y[i] = samples[i].k;
      if (i > 0) condition_ = std::max(condition_, condition(samples[i - 1], samples[i]));
    }
    pieces_.push_back(interpolate(x, y, nodes_));
    for (int power = 0; power < most_nodes; ++power) fit_.table.k[power][piece] = static_cast<float>(pieces_.back()[power] / fit_.table.scale);
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
    const double k = evaluate(pieces_[piece], x), dk = slope(pieces_[piece], x) * index_.scale * index_.slope(u);
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
      table.line_ends = false;
      return;
    }
    const double right = s / branch_.radius_high, right2 = s2 / *radius, determinant = c * s2 - c2 * s;
    table.beyond_z = static_cast<float>((right * s2 - right2 * s) / determinant);
    table.beyond_r = static_cast<float>((c * right2 - c2 * right) / determinant);
    const double blind_sine = std::sin(blind_from), blind_cosine = std::cos(blind_from);
    table.u_blind = edge(blind_sine, blind_cosine);
    // The line is a sinusoid of theta, which falls beyond its zero.
    table.line_ends = table.beyond_r * blind_sine + table.beyond_z * blind_cosine > 0.5 * blind_sine / FloatTable::blind_radius;
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

// Nothing where it is off by more than is allowed.
std::optional<FloatFit> try_fit(const Surface& surface, const Shape& shape, double allowed, double weight_error) {
  Fitter fitter(surface, shape);
  if (!fitter.fit(allowed)) return std::nullopt;
  const FloatFit fit = fitter.finish();
  return fit.weight_error <= weight_error ? std::optional(fit) : std::nullopt;
}

} // namespace

std::optional<FloatFit> make_float_table(const Surface& surface, double max_error) {
  const auto& branches = surface.branches();
  const Branch& first = branches.front();
  if (branches.size() != 1 || first.theta_low != 0 || first.orientation < 0 || first.fold_high) return std::nullopt;
  constexpr double fine_weight = 2.5e-3, usable_weight = 0.05; // any smooth positive weight draws the same picture
  constexpr double aim = 0.2;             // of what is allowed: look no further
  const Reach reach = first.theta_high > behind_from ? Reach::behind : Reach::ahead;
  constexpr struct {
    bool is_cosine;
    int pieces, degree;
  } sizes[] = {{true, 8, 5}, {true, 16, 5}, {false, 8, 5}, {true, 16, 7}, // the faster first
               {false, 8, 7}, {false, 16, 5}, {false, 16, 7}, {false, 32, 5}};
  for (const auto [is_cosine, pieces, degree] : sizes) {
    if (is_cosine && reach == Reach::behind) continue;
    for (const double alpha : {1.0, 4.0, 0.5, 2.0, 16.0, 0.25}) {
      const Shape shape{is_cosine ? Reach::cosine : reach, alpha, pieces, degree};
      const auto fit = try_fit(surface, shape, aim * max_error, pieces < FloatTable::most_pieces ? fine_weight : usable_weight);
      if (fit) return fit;
      if (is_cosine) break; // has no alpha
    }
  }
  std::optional<FloatFit> best;
  for (const double alpha : {16.0, 4.0, 1.0, 64.0}) {
    const Shape shape{reach, alpha, FloatTable::most_pieces, FloatTable::most_powers - 1, true};
    const auto fit = try_fit(surface, shape, best ? best->predicted_error : max_error, usable_weight);
    if (fit) best = fit;
    if (best && best->predicted_error <= aim * max_error) return best;
  }
  return best;
}

} // namespace domewarp
