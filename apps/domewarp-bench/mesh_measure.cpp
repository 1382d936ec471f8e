// SPDX-License-Identifier: Apache-2.0
#include "mesh_measure.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/core/quantile.h"
#include "domewarp/refine/tolerances.h"
#include "domewarp/refine/warped_vertex.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

constexpr double rounding = 1e-10; ///< image units: what the two maps differ by

Vec2 drawn(const Vec3& position, Projection projection) {
  return projection == Projection::perspective ? Vec2(position) / -position.z : Vec2(position);
}

/// The exact map ends at the rim; a chord of a rim beyond 90 degrees bulges out of it.
bool is_shown(const BranchMap& exact, const Vec3& eye) {
  const Vec2 inside = exact.inside(eye);
  return inside.x >= 0 && inside.y >= 0;
}

/// Of what the file draws: corners are rounded to float32.
double written_error(const RefinedMesh& mesh, const RefinedFace& face, const BranchMap& exact, Projection projection, const Vec3& weights) {
  Vec3 position(0), eye(0);
  for (int k = 0; k < 3; ++k) {
    position += weights[k] * Vec3(warped_position(mesh.points[face.point[k]], projection));
    eye += weights[k] * mesh.points[face.point[k]].eye;
  }
  return is_shown(exact, eye) ? glm::length(drawn(position, projection) - exact.image(eye)) : 0;
}

double edge_error(const MappedPoint& a, const MappedPoint& b, const BranchMap& exact, double t) {
  const Vec3 q = homogeneous(a.mapped) * (1 - t) + homogeneous(b.mapped) * t, eye = point_at(a.eye, b.eye, t);
  return is_shown(exact, eye) ? glm::length(dehomogenise(q) - exact.image(eye)) : 0;
}

/// Largest error of every edge that a face uses, -1 of the others.
std::vector<double> edge_errors(const RefinedMesh& mesh, const BranchMap& exact) {
  std::vector<double> errors(mesh.edges.size(), -1);
  for (const RefinedFace& face : mesh.faces)
    for (const std::uint32_t e : face.edge) errors[e] = 0;
  parallel_each(errors.size(), 256, [&](std::size_t e) {
    if (errors[e] < 0) return;
    const MappedPoint &a = mesh.points[mesh.edges[e].a], &b = mesh.points[mesh.edges[e].b];
    for (int s = 1; s < 64; ++s) errors[e] = std::max(errors[e], edge_error(a, b, exact, s / 64.0));
  });
  return errors;
}

/// Largest error of every face at the inner points of a grid.
std::vector<double> face_errors(const RefinedMesh& mesh, const BranchMap& exact, Projection projection) {
  constexpr int parts = 13;
  std::vector<double> errors(mesh.faces.size(), 0);
  parallel_each(errors.size(), 256, [&](std::size_t f) {
    for (int i = 1; i < parts; ++i)
      for (int j = 1; i + j < parts; ++j)
        errors[f] = std::max(errors[f], written_error(mesh, mesh.faces[f], exact, projection, Vec3(i, j, parts - i - j) / double(parts)));
  });
  return errors;
}

} // namespace

Display make_display(const std::string& name, const SurfaceOptions& options, const Raster& raster) {
  Surface surface(options, screen_radius(raster));
  ImageMap map = make_image_map(surface, Method::automatic), exact = make_image_map(surface, Method::direct);
  return {name, std::move(surface), std::move(map), std::move(exact)};
}

std::vector<std::pair<std::string, SurfaceOptions>> surfaces() {
  SurfaceOptions lens, parabola, hyperbola, cone;
  lens.lens = Lens::equidistant;
  lens.rmax = 1;
  parabola.curve = "1-r^2";
  hyperbola.curve = "3-sqrt(4+6*r^2)";
  cone.curve = "1-r";
  parabola.rmax = hyperbola.rmax = cone.rmax = 1.3;
  return {{"equidistant 180", lens}, {"1-r^2", parabola}, {"3-sqrt(4+6*r^2)", hyperbola}, {"1-r", cone}};
}

Refined refine_whole(Soup soup, const Display& display, const Raster& raster, const RefineOptions& options) {
  double extent = 0;
  for (const Vec3& point : soup.points) extent = std::max(extent, glm::length(point));
  const BranchMap& branch = display.map.branches.front();
  const EdgeOracle oracle(display.surface, 0, branch, make_visible_region(branch.branch(), 1e-5 * extent), oracle_options(options, raster));
  Refined refined{std::move(soup), {}, 0};
  const std::vector<std::uint8_t> plain(options.plain_tolerance_px > 0 ? refined.soup.faces.size() : 0, 1);
  refined.seconds = seconds([&] { refined.mesh = refine_levels(refined.soup, oracle, {options.max_triangles, nullptr, false, plain}); });
  return refined;
}

Judged judge(const Refined& refined, const Display& display, const Raster& raster, const RefineOptions& options) {
  const RefinedMesh& mesh = refined.mesh;
  const BranchMap& exact = display.exact.branches.front();
  const double tolerance = options.tolerance_px * pixel_size(raster), px = 1 / pixel_size(raster);
  const std::vector<double> edges = edge_errors(mesh, exact), faces = face_errors(mesh, exact, options.projection);
  Judged judged;
  std::vector<double> ratios, tight;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (edges[e] < 0) continue;
    const double certified = mesh.edges[e].error;
    ++judged.edges;
    judged.edge_violations += edges[e] > certified + rounding || certified > tolerance;
    judged.certified = std::max(judged.certified, certified * px);
    judged.edge_error = std::max(judged.edge_error, edges[e] * px);
    if (edges[e] < rounding) continue; // seen end-on: nothing to compare
    ratios.push_back(certified / edges[e]);
    if (certified >= 0.5 * tolerance) tight.push_back(ratios.back());
  }
  for (const double error : faces) {
    judged.face_violations += error > tolerance + rounding;
    judged.face_error = std::max(judged.face_error, error * px);
  }
  if (!ratios.empty()) judged.median_ratio = quantile(ratios, 2);
  if (!tight.empty()) judged.tight_ratio = quantile(tight, 2);
  return judged;
}

double sampled_error(const RefinedMesh& mesh, const Display& display, const Raster& raster, Projection projection,
                     const std::function<bool(const RefinedFace&)>& counts) {
  const BranchMap& branch = display.map.branches.front();
  constexpr int parts = 4;
  double worst = 0;
  std::mutex guard;
  parallel_ranges(mesh.faces.size(), 1024, [&](std::size_t begin, std::size_t end) {
    double here = 0;
    for (std::size_t f = begin; f < end; ++f) {
      const RefinedFace& face = mesh.faces[f];
      const auto is_visible = [&](std::uint32_t point) { return mesh.points[point].sides[0] >= 0; };
      if (!counts(face) || !std::all_of(face.point.begin(), face.point.end(), is_visible)) continue;
      for (int i = 0; i < parts; ++i)
        for (int j = i == 0 ? 1 : 0; i + j <= parts && j < parts; ++j)
          here = std::max(here, written_error(mesh, face, branch, projection, Vec3(i, j, parts - i - j) / double(parts)));
    }
    const std::lock_guard lock(guard);
    worst = std::max(worst, here);
  });
  return worst / pixel_size(raster);
}

} // namespace domewarp::bench
