// SPDX-License-Identifier: Apache-2.0
#include "map_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "domewarp/transform/batch.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double pixels_4096 = 2048; // per image unit

Surface make_surface(const std::string& curve, double r_max) {
  SurfaceOptions options;
  options.curve = curve;
  return {options, r_max};
}

Vec3 towards(double theta, double phi) { return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta)}; }

/// Directions within a branch: even ones, and some towards either end in powers of ten.
std::vector<Vec3> directions(const Branch& branch, std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double width = branch.theta_high - branch.theta_low;
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < count; ++i) {
    const double part = i % 4 > 0 ? uniform(random) : std::pow(10, -15 * uniform(random));
    all.push_back(towards(i % 8 == 4 ? branch.theta_high - width * part : branch.theta_low + width * part, 7 * uniform(random)));
  }
  return all;
}

struct Error {
  double most = 0, rms = 0;
};

Error float_error(const Surface& surface, const BatchMap& batch, const std::vector<Vec3>& points) {
  std::vector<float> in, out(3 * points.size());
  for (const Vec3& p : points) in.insert(in.end(), {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  batch.map(interleaved(in.data()), interleaved(out.data()), points.size(), BatchOutput::image);
  const ImageMap exact = make_image_map(surface, Method::direct);
  Error error;
  double count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ImagePoint point = project(surface, exact, {in[3 * i], in[3 * i + 1], in[3 * i + 2]});
    if (point.state != PointState::visible) continue;
    const double off = std::hypot(out[3 * i] - point.x, out[3 * i + 1] - point.y);
    error = {std::max(error.most, off), error.rms + off * off};
    ++count;
  }
  return {error.most, std::sqrt(error.rms / std::max(count, 1.0))};
}

double difference(const BranchMap& a, const BranchMap& b, const std::vector<Vec3>& points) {
  double most = 0;
  for (const Vec3& p : points) {
    const Vec2 at = a.image(p), other = b.image(p);
    most = std::max(most, std::hypot(at.x - other.x, at.y - other.y));
  }
  return most;
}

double ns_per_point(const Surface& surface, const ImageMap& map, const std::vector<Vec3>& points, int rounds) {
  double sum = 0; // keeps the work
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round)
    least = std::min(least, processor_seconds([&] {
                       for (const Vec3& p : points) sum += project(surface, map, p).depth;
                     }));
  return sum > 0 ? least * 1e9 / static_cast<double>(points.size()) : nothing;
}

std::vector<Cell> double_row(const std::string& curve, double r_max, bool quick) {
  const Surface surface = make_surface(curve, r_max);
  const int rounds = quick ? 1 : 9;
  const ImageMap direct = make_image_map(surface, Method::direct);
  ImageMap table = make_image_map(surface, Method::table);
  double pieces = 0, error = 0, build = std::numeric_limits<double>::infinity();
  bool used = true;
  std::vector<Vec3> all;
  for (int round = 0; round < rounds; ++round) {
    double total = 0;
    for (const BranchMap& branch : make_image_map(surface, Method::table).branches) total += branch.table().build_ms;
    build = std::min(build, total);
  }
  for (std::size_t i = 0; i < table.branches.size(); ++i) {
    const std::vector<Vec3> points = directions(surface.branches()[i], quick ? 200 : 20000);
    pieces += table.branches[i].table().pieces;
    used = used && table.branches[i].table().used;
    error = std::max(error, difference(table.branches[i], direct.branches[i], points));
    all.insert(all.end(), points.begin(), points.begin() + std::min<std::ptrdiff_t>(2000, static_cast<std::ptrdiff_t>(points.size())));
  }
  const double slow = ns_per_point(surface, direct, all, std::min(rounds, 3)), fast = ns_per_point(surface, table, all, rounds);
  return {curve, surface.r_max(), static_cast<double>(table.branches.size()), std::string(used ? "lut" : "direct"),
          pieces, error, build, slow, fast, build * 1e6 / (slow - fast)};
}

} // namespace

const std::vector<std::string>& map_curves() {
  static const std::vector<std::string> curves{"1-r^2", "-r+1", "-2r+1", "3-sqrt(4+6*r^2)", "sqrt(1-r^2)", "-r^3+r^2+r+1", "-2.5r^2+1",
                                               "2-(r+0.01)^r", "-log(r+0.1)", "-tanh(r-1)", "r/tan(r*pi/2)",
                                               "-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1", "1-abs(r-.37)", "sqrt(abs(1-r^2))"};
  return curves;
}

Table float_tables(const Options& options) {
  Table table{"float_tables",
              "Tables in single precision; error of visible directions, even ones and ones close to the axis and the rim; they pay from the last column's number of points on",
              {{"curve", "curve"}, {"r_max", "r_max"}, {"method", "method"}, {"pieces", "pieces"}, {"build_ms", "build (ms)"},
               {"predicted_error", "predicted error"}, {"max_error", "max error"}, {"rms_error", "RMS error"}, {"px_4096", "max px at 4096"},
               {"px_8192", "max px at 8192"}, {"pays_from", "pays from"}},
              {}};
  for (const std::string& curve : map_curves())
    for (const double r_max : {1.0, 5.0 / 3}) {
      options.progress("float table of " + curve);
      const Surface surface = make_surface(curve, r_max);
      double build = std::numeric_limits<double>::infinity();
      for (int round = 0; round < (options.quick ? 1 : 9); ++round) build = std::min(build, BatchMap(surface).report().build_ms);
      const BatchMap batch(surface);
      const BatchReport& report = batch.report();
      const std::vector<Vec3> points = directions(surface.branches().front(), options.quick ? 200 : 50000);
      const Error error = float_error(surface, batch, points);
      const std::vector<Vec3> few(points.begin(), points.begin() + std::min<std::ptrdiff_t>(2000, static_cast<std::ptrdiff_t>(points.size())));
      const double direct_ns = ns_per_point(surface, make_image_map(surface, Method::direct), few, options.quick ? 1 : 5);
      table.rows.push_back({curve, surface.r_max(), std::string(report.vectorised ? "float" : report.direct ? "direct" : "double"),
                            static_cast<double>(report.pieces), build, report.vectorised ? report.predicted_error : nothing, error.most,
                            error.rms, pixels_4096 * error.most, 2 * pixels_4096 * error.most,
                            report.vectorised ? build * 1e6 / direct_ns : nothing});
    }
  return table;
}

Table double_tables(const Options& options) {
  Table table{"double_tables",
              "Tables in double precision, all branches together; they pay from the last column's number of points on",
              {{"curve", "curve"}, {"r_max", "r_max"}, {"branches", "branches"}, {"method", "method"}, {"pieces", "pieces"},
               {"max_error", "max error"}, {"build_ms", "build (ms)"}, {"direct_ns", "direct (ns)"}, {"table_ns", "table (ns)"},
               {"pays_from", "pays from"}},
              {}};
  for (const std::string& curve : map_curves())
    for (const double r_max : {1.0, 5.0 / 3}) {
      options.progress("double table of " + curve);
      table.rows.push_back(double_row(curve, r_max, options.quick));
    }
  options.progress("double table of -tanh(r-1) up to its fold");
  table.rows.push_back(double_row("-tanh(r-1)", 3, options.quick));
  return table;
}

} // namespace domewarp::bench
