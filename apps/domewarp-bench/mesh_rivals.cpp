// SPDX-License-Identifier: Apache-2.0
#include "mesh_rivals.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "bench_scenes.h"
#include "domewarp/scene/test_scenes.h"
#include "lower_bound.h"
#include "mesh_measure.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

constexpr int most_lod = 12;
constexpr double large_angle = 10 * 0.017453292519943295; ///< radians

/// How a rival got to the error wanted: interpolated between the coarser and the finer of its meshes, which is in its favour.
struct Reached {
  double triangles = 0, seconds = 0;
  bool reached = false; ///< false: the figures are those of its finest mesh, which is still worse
};

/// Whether some side of the face is seen under more than the angle that makes it large.
bool is_large(const Soup& soup, const SoupFace& face) {
  const Triangle point = points_of(soup, face);
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = soup.points[point[k]], b = soup.points[point[(k + 1) % 3]];
    if (glm::dot(a, b) < std::cos(large_angle) * glm::length(a) * glm::length(b)) return true;
  }
  return false;
}

/// The faces alone, for the rivals, which know no topology.
Soup only(const Soup& soup, bool large) {
  Soup part = soup;
  if (large) std::erase_if(part.faces, [&](const SoupFace& face) { return !is_large(soup, face); });
  return part;
}

class Rival {
public:
  Rival(const Soup& soup, const Display& display, const Raster& raster, std::size_t most)
      : soup_(soup), display_(display), raster_(raster), most_(most) {}

  /// Tries finer and finer meshes. @param finer options of step 0, 1, ...
  Reached reach(double wanted, const std::function<IsotropicOptions(int)>& finer) const {
    Reached now;
    double error = 0;
    for (int step = 0; step < 60; ++step) {
      const Reached before = now;
      const double error_before = error;
      IsotropicReport report;
      RefinedMesh mesh;
      now.seconds = seconds([&] {
        mesh = subdivide_isotropic(soup_, display_.surface, display_.map, Projection::perspective, finer(step), most_, report);
      });
      if (report.stopped) return before;
      now.triangles = static_cast<double>(mesh.faces.size());
      if (now.triangles == before.triangles && mesh.levels >= static_cast<std::size_t>(most_lod)) return now; // nothing may be divided more often
      error = sampled_error(mesh, display_, raster_, Projection::perspective, [](const RefinedFace&) { return true; });
      if (error > wanted) continue;
      if (step == 0 || error_before <= error) return {now.triangles, now.seconds, true};
      const double share = std::log(error_before / wanted) / std::log(error_before / error);
      const auto between = [&](double coarse, double fine) { return coarse * std::pow(fine / coarse, share); };
      return {between(before.triangles, now.triangles), between(before.seconds, now.seconds), true};
    }
    return now;
  }

  Reached by_length(double wanted) const {
    return reach(wanted, [](int step) { return IsotropicOptions{std::pow(0.5, 0.5 * step), most_lod}; });
  }

  Reached alike(double wanted) const {
    return reach(wanted, [](int step) { return IsotropicOptions{1e-300, std::min(step, most_lod)}; });
  }

private:
  const Soup& soup_;
  const Display& display_;
  const Raster& raster_;
  std::size_t most_;
};

void add_row(Table& table, const std::string& scene, const Display& display, const char* part, double triangles, double error,
             const Reached& by_length, const Reached& alike) {
  table.rows.push_back({scene, display.name, part, triangles, error, by_length.triangles, by_length.triangles / triangles,
                        by_length.reached ? "yes" : "no", alike.triangles, alike.triangles / triangles, alike.reached ? "yes" : "no"});
}

} // namespace

Table compare_with_rivals(const Options& options) {
  const Raster raster = options.quick ? Raster{256, 256} : Raster{1024, 1024};
  const std::size_t most = options.quick ? 50'000 : 1'000'000;
  Table table{"mesh_rivals",
              "Triangles at equal measured error (0.5 px of " + std::to_string(raster.height) +
                  " rows asked of the adaptive mesh, any depth): by length is the thesis' recursion, uniform cuts every triangle alike. Where one "
                  "did not reach the error within " + std::to_string(most) + " triangles, its count is that of its finest mesh",
              {{"scene", "scene"}, {"surface", "surface"}, {"part", "part"}, {"adaptive", "adaptive"}, {"error_px", "error px"},
               {"by_length", "by length"}, {"by_length_ratio", "ratio"}, {"by_length_reached", "reached"},
               {"uniform", "uniform"}, {"uniform_ratio", "ratio"}, {"uniform_reached", "reached"}},
              {}};
  const auto displays = surfaces();
  for (const TestScene& test : make_test_scenes())
    for (std::size_t s = 0; s < 2; ++s) {
      options.progress("against rivals: " + test.name + ", " + displays[s].first);
      const Display display = make_display(displays[s].first, displays[s].second, raster);
      RefineOptions refine;
      refine.depth_tolerance = 1e30; // which the rivals know nothing of
      const Refined refined = refine_whole(make_soup(test.scene, resolve_view(test.scene, {}), {}), display, raster, refine);
      for (const bool large : {true, false}) {
        const auto counts = [&](const RefinedFace& face) { return !large || is_large(refined.soup, refined.soup.faces[face.source]); };
        const auto triangles = static_cast<double>(std::count_if(refined.mesh.faces.begin(), refined.mesh.faces.end(), counts));
        if (triangles == 0) continue;
        const double error = sampled_error(refined.mesh, display, raster, Projection::perspective, counts);
        const Soup soup = only(refined.soup, large);
        const Rival rival(soup, display, raster, most);
        add_row(table, test.name, display, large ? "large" : "all", triangles, error, rival.by_length(error), rival.alike(error));
      }
    }
  return table;
}

Table sweep_tolerances(const Options& options) {
  const Raster raster = options.quick ? Raster{256, 256} : Raster{1024, 1024};
  const std::size_t most = options.quick ? 50'000 : 2'000'000;
  const int rounds = options.quick ? 1 : 3;
  Table table{"mesh_tolerances",
              "The box on 1-r^2, r_max 1.3, at " + std::to_string(raster.height) + " rows: triangles and time against error, any depth, least of " +
                  std::to_string(rounds) + ". The rivals are taken at the error that the adaptive mesh has, measured; within " + std::to_string(most) + " triangles",
              {{"tolerance_px", "tolerance px"}, {"error_px", "error px"}, {"adaptive", "adaptive"}, {"adaptive_ms", "ms"},
               {"by_length", "by length"}, {"by_length_ms", "ms"}, {"by_length_reached", "reached"},
               {"uniform", "uniform"}, {"uniform_ms", "ms"}, {"uniform_reached", "reached"},
               {"orthographic_error_px", "error px"}, {"orthographic", "orthographic"}, {"orthographic_ms", "ms"}, {"lower_bound", "N*"}},
              {}};
  const auto [name, surface] = surfaces()[1];
  const Display display = make_display(name, surface, raster);
  const auto adapt = [&](double tolerance, Projection projection) {
    RefineOptions refine;
    refine.tolerance_px = tolerance;
    refine.depth_tolerance = 1e30;
    refine.projection = projection;
    Refined refined = refine_whole(make_soup(box(), View{}, {}), display, raster, refine);
    for (int round = 1; round < rounds; ++round)
      refined.seconds = std::min(refined.seconds, refine_whole(make_soup(box(), View{}, {}), display, raster, refine).seconds);
    return refined;
  };
  const auto triangles = [](const Refined& refined) { return static_cast<double>(refined.mesh.faces.size()); };
  for (const double tolerance : options.quick ? std::vector<double>{4, 1} : std::vector<double>{4, 2, 1, 0.5, 0.2, 0.1, 0.05}) {
    options.progress("box at " + std::to_string(tolerance) + " px");
    const Refined adaptive = adapt(tolerance, Projection::perspective), orthographic = adapt(tolerance, Projection::orthographic);
    const auto measured = [&](const Refined& refined, Projection projection) {
      return sampled_error(refined.mesh, display, raster, projection, [](const RefinedFace&) { return true; });
    };
    const double error = measured(adaptive, Projection::perspective);
    const Rival rival(adaptive.soup, display, raster, most);
    const Reached by_length = rival.by_length(error), alike = rival.alike(error);
    const double least = least_triangles(box(), display.exact.branches.front(), tolerance * pixel_size(raster), options.quick ? 6 : 24);
    table.rows.push_back({tolerance, error, triangles(adaptive), 1000 * adaptive.seconds, by_length.triangles, 1000 * by_length.seconds,
                          by_length.reached ? "yes" : "no", alike.triangles, 1000 * alike.seconds, alike.reached ? "yes" : "no",
                          measured(orthographic, Projection::orthographic), triangles(orthographic), 1000 * orthographic.seconds, least});
  }
  return table;
}

} // namespace domewarp::bench
