// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "benches.h"
#include "domewarp/transform/image_map.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

std::vector<Vec3> random_points(std::size_t count) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {normal(random), normal(random), -std::abs(normal(random))};
  return points;
}

} // namespace

Result run_map_bench(const Options& options) {
  const std::vector<Vec3> points = random_points(options.quick ? 1000 : 100000);
  std::vector<Vec2> images(points.size());
  const Surface surface({.curve = "1-r^2"}, 1);
  const BranchMap direct(surface, 0, Method::direct), table(surface, 0, Method::table);
  const auto all = [&](const BranchMap& map) {
    return [&] {
      for (std::size_t i = 0; i < points.size(); ++i) images[i] = map.image(points[i]);
    };
  };
  const std::vector<double> times = least_seconds({all(direct), all(table)}, options.quick ? 1 : 5);
  const double each = 1e9 / static_cast<double>(points.size());
  return {{{"map",
            "The map of 1-r^2 in double precision",
            {{"method", "method"}, {"ns_per_vertex", "ns/vertex"}},
            {{"direct", times[0] * each}, {"table", times[1] * each}}}},
          {},
          {}};
}

} // namespace domewarp::bench
