// SPDX-License-Identifier: Apache-2.0
//
// The map under attack, judged by sixty digits. DOMEWARP_STRESS=1000000 sets the number of points per surface and
// method (default 2000), and says when each surface is done; the seed is printed with every failure.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "domewarp/core/parallel.h"
#include "domewarp/transform/batch.h"
#include "oracle.h"
#include "surfaces.h"

namespace domewarp {
namespace {

constexpr double pi = std::numbers::pi;

int stress_count() {
  const char* text = std::getenv("DOMEWARP_STRESS");
  return text != nullptr ? std::atoi(text) : 2000;
}

// Points that have broken maps before, and random ones.
class Attack {
public:
  Attack(const Surface& surface, std::uint64_t seed) : random_(seed), critical_(critical_angles(surface)) {}

  Vec3 next() {
    Vec3 p = at_some_size(direction());
    if (random_() % 4 == 0) p = Vec3(Vec3f(p)); // as a float mesh would give it
    if (random_() % 64 == 0) p[static_cast<int>(random_() % 3)] = odd_number();
    return p;
  }

private:
  double uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  double tiny(double least) { return std::pow(10, least * uniform()) * (random_() % 2 == 0 ? 1 : -1); }

  Vec3 direction() {
    const double phi = 7 * uniform();
    switch (random_() % 6) {
    case 0: return towards(std::acos(1 - 2 * uniform()), phi);
    case 1: return towards(pi * uniform(), phi);
    case 2: { // near the axis, either way
      const double offset = tiny(-320);
      return {offset * std::cos(phi), offset * std::sin(phi), random_() % 2 == 0 ? 1 : -1};
    }
    case 3: { // near an end of a branch or of the blind cone, from both sides
      const double at = critical_[random_() % critical_.size()];
      return towards(std::clamp(at + tiny(-17), 0.0, pi), random_() % 2 == 0 ? 0 : phi);
    }
    case 4: { // some roundings from it
      Vec3 p = towards(critical_[random_() % critical_.size()], random_() % 2 == 0 ? 0 : phi);
      for (int i = 0; i < 3; ++i)
        for (std::uint64_t n = random_() % 3; n > 0; --n) p[i] = std::nextafter(p[i], uniform() - 0.5);
      return p;
    }
    default: return {std::cos(phi), std::sin(phi), random_() % 2 == 0 ? 0.0 : tiny(-320)}; // 90 degrees
    }
  }

  Vec3 at_some_size(const Vec3& direction) {
    if (random_() % 2 == 0) return direction;
    return direction * std::pow(10, random_() % 8 == 0 ? 600 * uniform() - 300 : 78 * uniform() - 40);
  }

  double odd_number() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double odd[] = {0.0, -0.0, 5e-324, -1e-310, 1e-160, 1e-40, 1e38, 1e200, -1.7e308, infinity, -infinity,
                          std::nan("")};
    return odd[random_() % std::size(odd)];
  }

  std::mt19937_64 random_;
  std::vector<double> critical_;
};

double exact_length(const Vec3& p) {
  return static_cast<double>(sqrt(Real(p.x) * Real(p.x) + Real(p.y) * Real(p.y) + Real(p.z) * Real(p.z)));
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

Vec3 unit(const Vec3& p) {
  const double size = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const int exponent = std::ilogb(size);
  return glm::normalize(Vec3(std::scalbn(p.x, -exponent), std::scalbn(p.y, -exponent), std::scalbn(p.z, -exponent)));
}

struct Tolerance {
  double relative, absolute; // of the image radius
};

// What is wrong with the image of p; empty when nothing is.
std::string objection(const Case& the, const ImageMap& map, const Vec3& p, const Tolerance& tolerance, int& on_edge) {
  const ImagePoint point = project(the.surface, map, p);
  const bool is_usable = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && p != Vec3(0);
  if (!is_usable) {
    const bool is_blind = point.state == PointState::blind && std::isnan(point.x) && std::isnan(point.y);
    return is_blind ? "" : "no direction, yet " + std::string(to_string(point.state));
  }
  const Oracle::Answer expected = the.oracle->answer(p);
  on_edge += expected.is_close && expected.state != expected.other;
  if (point.state != expected.state && !(expected.is_close && point.state == expected.other))
    return std::string(to_string(point.state)) + " instead of " + to_string(expected.state);
  const double length = exact_length(p);
  if (!(std::abs(point.depth - length) <= 4e-16 * length + 5e-324)) return "depth " + std::to_string(point.depth);
  if (point.state == PointState::blind) return std::isnan(point.x) && std::isnan(point.y) ? "" : "a blind point has an image";
  if (!std::isfinite(point.x) || !std::isfinite(point.y)) return "no finite image";
  const double radius = std::hypot(point.x, point.y), r_max = the.surface.r_max();
  if (point.state == PointState::extended) return radius < r_max * (1 - 4e-16) ? "extended inside r_max" : "";
  if (radius > r_max * (1 + 2e-15)) return "visible outside r_max";
  const Vec3 way = unit(p);
  const double sine = std::hypot(way.x, way.y);
  const double across = std::abs(point.x * way.y - point.y * way.x);
  if (sine > 0 && across > 1e-15 * radius * sine + 1e-320) return "turned about the axis";
  if (sine > 1e-290 && !the.oracle->confirms(expected.branch, p, radius, tolerance.relative, tolerance.absolute))
    return "image radius " + std::to_string(radius) + " is off";
  Vec3 back;
  if (!unproject(the.surface, {point.x, point.y}, back)) return "the image has no ray";
  // Where the image does not tell directions apart (a vertical tangent), the ray must have that very image.
  if (angle_between(back, way) <= 1e-12 || the.oracle->confirms(expected.branch, back, radius, 2e-15, 0)) return "";
  return "the ray of the image is " + std::to_string(angle_between(back, way)) + " away";
}

// Attacks every surface, on all processors; `object` says what is wrong with the image of a point.
// @param prepare makes from a surface what `object` takes, once for each
template <typename Prepare, typename Object>
void attack(const char* name, const Prepare& prepare, const Object& object) {
  const std::vector<Case> cases = all_cases();
  parallel_each(cases.size(), 1, [&](std::size_t index) {
    const Case& the = cases[index];
    const auto map = prepare(the.surface);
    const std::uint64_t seed = index + 2;
    Attack points(the.surface, seed);
    int failures = 0, on_edge = 0;
    for (int i = 0; i < stress_count() && failures < 5; ++i) {
      const Vec3 p = points.next();
      const std::string what = object(the, map, p, on_edge);
      if (what.empty()) continue;
      ++failures;
      ADD_FAILURE() << the.name << ", seed " << seed << ", point " << i << " (" << p.x << ", " << p.y << ", " << p.z
                    << ") at " << std::atan2(std::hypot(p.x, p.y), -p.z) << ": " << what;
    }
    if (std::getenv("DOMEWARP_STRESS") == nullptr) return;
    std::printf("%s: %s: %d points, %d on an edge, %d objections\n", name, the.name.c_str(), stress_count(), on_edge, failures);
    std::fflush(stdout);
  });
}

void attack(const char* name, Method method, const Tolerance& tolerance) {
  attack(name, [&](const Surface& surface) { return make_image_map(surface, method); },
         [&](const Case& the, const ImageMap& map, const Vec3& p, int& on_edge) { return objection(the, map, p, tolerance, on_edge); });
}

TEST(Stability, TheDirectMethodWithstandsTheAttack) { attack("direct", Method::direct, {1e-13, 0}); }

TEST(Stability, TheTableWithstandsTheAttack) { attack("table", Method::table, {0, 1e-10}); }

// Where float rounds the direction itself decides the side of an edge.
bool is_near_edge(const std::vector<double>& critical, double theta) {
  return std::ranges::any_of(critical, [&](double angle) { return std::abs(theta - angle) < 3e-6; });
}

// What is wrong with where an array of floats has p.
std::string batch_objection(const Case& the, const BatchMap& map, const std::vector<double>& critical, const Vec3& p, int& near_edge) {
  const Vec3f in(p);
  Vec3f out;
  map.map(interleaved(&in.x), interleaved(&out.x), 1, BatchOutput::image);
  const Vec3 q(in);
  const bool is_usable = std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z) && q != Vec3(0);
  if (!is_usable) return std::isnan(out.x) && std::isnan(out.y) && std::isnan(out.z) ? "" : "no direction, yet an image";
  if (!std::isfinite(out.x) || !std::isfinite(out.y)) return "no finite image";
  const double radius = std::hypot(double(out.x), double(out.y)), length = exact_length(q), r_max = the.surface.r_max();
  // Denormal lengths have few digits; beyond the range of float they are infinite.
  if (length < 3.4e38 && std::abs(out.z - length) > 3e-7 * length + 3e-45) return "depth " + std::to_string(out.z);
  const Vec3 way = unit(q);
  const double sine = std::hypot(way.x, way.y);
  if (std::abs(out.x * way.y - out.y * way.x) > 5e-7 * radius * sine + 3e-45) return "turned about the axis";
  const double error = map.report().vectorised ? 1.5 * map.report().predicted_error : 2e-7 * r_max;
  if (is_near_edge(critical, std::atan2(sine, -way.z))) {
    ++near_edge;
    return "";
  }
  const Oracle::Answer expected = the.oracle->answer(q);
  if (expected.state == PointState::blind) return radius > 0.999e4 ? "" : "a blind point within the picture";
  if (expected.state == PointState::extended) return radius < r_max - error ? "extended inside r_max" : "";
  if (radius > r_max + error) return "visible outside r_max";
  return the.oracle->confirms(expected.branch, q, radius, 0, error) ? "" : "image radius " + std::to_string(radius) + " is off";
}

struct Floats {
  BatchMap map;
  std::vector<double> critical;
};

TEST(Stability, ArraysOfFloatsWithstandTheAttack) {
  attack("float", [](const Surface& surface) { return Floats{BatchMap(surface), critical_angles(surface)}; },
         [](const Case& the, const Floats& floats, const Vec3& p, int& near_edge) {
           return batch_objection(the, floats.map, floats.critical, p, near_edge);
         });
}

TEST(Stability, TheOracleNoticesAnotherSurface) {
  const ReferenceCurve curve = reference_curves().front();
  const Case right = curve_case(curve, corner_radius, 0);
  SurfaceOptions options;
  options.curve = "1-1.0000000000004r^2";
  const Case wrong{right.name, Surface(options, corner_radius), curve_case(curve, corner_radius, 0).oracle};
  const ImageMap map = make_image_map(wrong.surface, Method::direct);
  int objections = 0, on_edge = 0;
  Attack points(wrong.surface, 1);
  for (int i = 0; i < 1000; ++i) objections += !objection(wrong, map, points.next(), {1e-13, 0}, on_edge).empty();
  EXPECT_GT(objections, 300);
}

} // namespace
} // namespace domewarp
