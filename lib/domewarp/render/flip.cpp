// SPDX-License-Identifier: Apache-2.0
// Based on: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference Evaluator for
// Alternating Images", Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020 (HPG).
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "domewarp/core/parallel.h"
#include "domewarp/core/vectors.h"
#include "domewarp/render/image_metrics.h"
#include "domewarp/render/shading.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace domewarp {

namespace {

using Kernel = std::vector<float>; ///< odd length, centre in the middle
using Plane = std::vector<float>;  ///< rows of the picture's width

constexpr int strip = 64; ///< rows that are worked on at once

/// Linear Rec. 709 to CIE XYZ, D65; the white is its image of (1, 1, 1).
const Mat3 xyz_of_rgb = glm::transpose(Mat3(10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,
                                            2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,
                                            1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382));
const Vec3 white = xyz_of_rgb * Vec3(1);

/// The linear opponent space: luminance, red-green, blue-yellow.
Vec3 opponent_of_rgb(const Vec3& rgb) {
  const Vec3 t = xyz_of_rgb * rgb / white;
  return {116 * t.y - 16, 500 * (t.x - t.y), 200 * (t.y - t.z)};
}

Vec3 rgb_of_opponent(const Vec3& o) {
  static const Mat3 rgb_of_xyz = glm::inverse(xyz_of_rgb);
  const double y = (o.x + 16) / 116;
  return rgb_of_xyz * (Vec3(o.y / 500 + y, y, y - o.z / 200) * white);
}

/// CIELAB with chroma reduced in the dark (Hunt effect).
Vec3 hunt_lab_of_rgb(const Vec3& rgb) {
  constexpr double delta = 6.0 / 29;
  const auto f = [](double t) {
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  };
  const Vec3 t = xyz_of_rgb * rgb / white;
  const double x = f(t.x), y = f(t.y), z = f(t.z), l = 116 * y - 16;
  return {l, 0.01 * l * 500 * (x - y), 0.01 * l * 200 * (y - z)};
}

/// The HyAB distance.
double colour_distance(const Vec3& a, const Vec3& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

/// Compresses a HyAB distance to 0 .. 1.
double colour_difference(double distance) {
  constexpr double exponent = 0.7, knee = 0.4, knee_value = 0.95;
  static const double largest =
      std::pow(colour_distance(hunt_lab_of_rgb({0, 1, 0}), hunt_lab_of_rgb({0, 0, 1})), exponent);
  const double power = std::pow(distance, exponent), at = knee * largest;
  return power < at ? knee_value / at * power : knee_value + (power - at) / (largest - at) * (1 - knee_value);
}

template <typename Function>
Kernel make_kernel(int radius, Function&& value) {
  Kernel kernel;
  for (int x = -radius; x <= radius; ++x) kernel.push_back(static_cast<float>(value(x)));
  return kernel;
}

/// Positive and negative entries are scaled to sum up to 1 and -1.
Kernel normalised(Kernel kernel) {
  double positive = 0, negative = 0;
  for (const float v : kernel) (v > 0 ? positive : negative) += v;
  for (float& v : kernel) v = static_cast<float>(v > 0 ? v / positive : negative < 0 ? -v / negative : v);
  return kernel;
}

/// One Gaussian of a contrast sensitivity function, exp(-pi^2 x^2 / b) in degrees; `mass` is its share of the whole.
struct Sensitivity {
  Kernel kernel;
  double mass = 1;
};

Sensitivity make_sensitivity(int radius, double pixels_per_degree, double a, double b) {
  constexpr double pi = std::numbers::pi;
  Sensitivity s;
  s.kernel = make_kernel(radius, [&](int x) {
    const double degrees = x / pixels_per_degree;
    return std::exp(-pi * pi * degrees * degrees / b);
  });
  const double sum = std::accumulate(s.kernel.begin(), s.kernel.end(), 0.0);
  s.mass = a * std::sqrt(pi / b) * sum * sum;
  s.kernel = normalised(s.kernel);
  return s;
}

struct Filters {
  int radius = 0; ///< the larger of the two
  Sensitivity luminance, red_green, blue_yellow, blue_yellow_fine;
  Kernel smooth, slope, bend; ///< for edges and points
};

Filters make_filters(double ppd) {
  constexpr double widest = 0.04, feature_width = 0.082;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * std::numbers::pi * std::numbers::pi)) * ppd));
  const double sigma = 0.5 * feature_width * ppd;
  const int feature_radius = static_cast<int>(std::ceil(3 * sigma));
  const auto gauss = [sigma](int x) { return std::exp(-0.5 * x * x / (sigma * sigma)); };
  Filters f;
  f.radius = std::max(radius, feature_radius);
  f.luminance = make_sensitivity(radius, ppd, 1, 0.0047);
  f.red_green = make_sensitivity(radius, ppd, 1, 0.0053);
  f.blue_yellow = make_sensitivity(radius, ppd, 34.1, 0.04);
  f.blue_yellow_fine = make_sensitivity(radius, ppd, 13.5, 0.025);
  const double mass = f.blue_yellow.mass + f.blue_yellow_fine.mass;
  f.blue_yellow.mass /= mass;
  f.blue_yellow_fine.mass /= mass;
  f.smooth = normalised(make_kernel(feature_radius, gauss));
  f.slope = normalised(make_kernel(feature_radius, [&](int x) { return -x * gauss(x); }));
  f.bend = normalised(make_kernel(feature_radius, [&](int x) { return (x * x / (sigma * sigma) - 1) * gauss(x); }));
  return f;
}

/// Rows of one picture around a strip, the picture's border repeated outside it.
struct Strip {
  int width = 0, rows = 0, apron = 0; ///< apron: rows above and below that are needed as input only
};

void filter_across(const Strip& s, const Plane& in, const Kernel& kernel, Plane& out) {
  const int radius = static_cast<int>(kernel.size()) / 2;
  std::vector<float> line(std::size_t(s.width + 2 * radius));
  out.resize(in.size());
  for (int y = 0; y < s.rows + 2 * s.apron; ++y) {
    const float* row = &in[std::size_t(y) * std::size_t(s.width)];
    for (int x = 0; x < s.width + 2 * radius; ++x) line[std::size_t(x)] = row[std::clamp(x - radius, 0, s.width - 1)];
    float* target = &out[std::size_t(y) * std::size_t(s.width)];
    std::fill(target, target + s.width, 0.0f);
    for (std::size_t k = 0; k < kernel.size(); ++k)
      for (int x = 0; x < s.width; ++x) target[x] += kernel[k] * line[std::size_t(x) + k];
  }
}

/// @return the rows without the apron
Plane filter_down(const Strip& s, const Plane& in, const Kernel& kernel) {
  const int radius = static_cast<int>(kernel.size()) / 2;
  Plane out(std::size_t(s.width) * std::size_t(s.rows), 0.0f);
  for (int y = 0; y < s.rows; ++y)
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const float* row = &in[std::size_t(y + s.apron - radius + static_cast<int>(k)) * std::size_t(s.width)];
      float* target = &out[std::size_t(y) * std::size_t(s.width)];
      for (int x = 0; x < s.width; ++x) target[x] += kernel[k] * row[x];
    }
  return out;
}

Plane filter(const Strip& s, const Plane& in, const Kernel& across, const Kernel& down) {
  Plane between;
  filter_across(s, in, across, between);
  return filter_down(s, between, down);
}

/// What FLIP compares, for the pixels of a strip.
struct Seen {
  Plane colour[3]; ///< after the eye's contrast sensitivity, opponent space
  Plane edge[2], point[2];
};

Seen look_at(const Pixels& picture, int top, const Strip& s, const Filters& f) {
  Plane channel[3], luminance;
  for (Plane& plane : channel) plane.reserve(std::size_t(s.width) * std::size_t(s.rows + 2 * s.apron));
  for (int y = top - s.apron; y < top + s.rows + s.apron; ++y) {
    const int row = std::clamp(y, 0, picture.height - 1);
    for (int x = 0; x < s.width; ++x) {
      const std::uint8_t* p = &picture.rgba[4 * (std::size_t(row) * std::size_t(s.width) + std::size_t(x))];
      const Vec3 o = opponent_of_rgb(p[3] / 255.0 * Vec3(linear_of_srgb(p[0]), linear_of_srgb(p[1]), linear_of_srgb(p[2])));
      for (int k = 0; k < 3; ++k) channel[k].push_back(static_cast<float>(o[k]));
      luminance.push_back(static_cast<float>((o.x + 16) / 116));
    }
  }
  Seen seen;
  seen.colour[0] = filter(s, channel[0], f.luminance.kernel, f.luminance.kernel);
  seen.colour[1] = filter(s, channel[1], f.red_green.kernel, f.red_green.kernel);
  seen.colour[2] = filter(s, channel[2], f.blue_yellow.kernel, f.blue_yellow.kernel);
  const Plane fine = filter(s, channel[2], f.blue_yellow_fine.kernel, f.blue_yellow_fine.kernel);
  for (std::size_t i = 0; i < fine.size(); ++i)
    seen.colour[2][i] = static_cast<float>(f.blue_yellow.mass * seen.colour[2][i] + f.blue_yellow_fine.mass * fine[i]);
  seen.edge[0] = filter(s, luminance, f.slope, f.smooth);
  seen.edge[1] = filter(s, luminance, f.smooth, f.slope);
  seen.point[0] = filter(s, luminance, f.bend, f.smooth);
  seen.point[1] = filter(s, luminance, f.smooth, f.bend);
  return seen;
}

Vec3 seen_colour(const Seen& seen, std::size_t i) {
  const Vec3 rgb = rgb_of_opponent({seen.colour[0][i], seen.colour[1][i], seen.colour[2][i]});
  return hunt_lab_of_rgb(glm::clamp(rgb, 0.0, 1.0));
}

double magnitude(const Plane (&plane)[2], std::size_t i) {
  return std::hypot(double(plane[0][i]), double(plane[1][i]));
}

double difference(const Seen& a, const Seen& b, std::size_t i) {
  const double colour = colour_difference(colour_distance(seen_colour(a, i), seen_colour(b, i)));
  const double edge = std::abs(magnitude(a.edge, i) - magnitude(b.edge, i));
  const double point = std::abs(magnitude(a.point, i) - magnitude(b.point, i));
  const double feature = std::sqrt(std::max(edge, point) / std::numbers::sqrt2);
  return std::pow(colour, 1 - feature);
}

} // namespace

FlipReport flip(const Pixels& reference, const Pixels& test, double pixels_per_degree) {
  const Filters filters = make_filters(pixels_per_degree);
  std::vector<FlipReport> strips(std::size_t((reference.height + strip - 1) / strip)); // means are sums here
  parallel_each(strips.size(), 1, [&](std::size_t n) {
    const int top = static_cast<int>(n) * strip;
    const Strip s{reference.width, std::min(strip, reference.height - top), filters.radius};
    const Seen a = look_at(reference, top, s, filters), b = look_at(test, top, s, filters);
    for (std::size_t i = 0; i < a.colour[0].size(); ++i) {
      const double value = difference(a, b, i);
      strips[n].mean += value;
      strips[n].max = std::max(strips[n].max, value);
    }
  });
  FlipReport report;
  for (const FlipReport& s : strips) {
    report.mean += s.mean;
    report.max = std::max(report.max, s.max);
  }
  report.mean /= double(reference.width) * reference.height;
  return report;
}

} // namespace domewarp
