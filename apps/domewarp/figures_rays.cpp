// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/render/simulate.h"
#include "domewarp/scene/view.h"
#include "figures.h"

namespace domewarp {

const Scene& Studio::scene(const std::string& name) const {
  const auto found = std::find_if(scenes.begin(), scenes.end(), [&](const TestScene& s) { return s.name == name; });
  if (found == scenes.end()) throw Error(ErrorCode::usage, "figures: there is no scene " + name);
  return found->scene;
}

SurfaceOptions curve(const std::string& f, std::optional<double> projector, std::optional<double> rmax) {
  SurfaceOptions options;
  options.curve = f;
  options.projector = projector;
  options.rmax = rmax;
  return options;
}

namespace {

constexpr const char* sphere = "sqrt(1-r^2)";
constexpr const char* hyperbola = "3-sqrt(4+6*r^2)";

RayTraceOptions ray_options(int samples) {
  RayTraceOptions options;
  options.samples = samples;
  options.layers = Layers::colours;
  return options;
}

Frame trace(const Studio& studio, const Scene& scene, const SurfaceOptions& options, const RayTraceOptions& rays) {
  return ray_trace(scene, resolve_view(scene, {}), Surface(options, screen_radius(studio.raster)), studio.raster, rays);
}

void add_surfaces(const Studio& studio, std::vector<Figure>& figures) {
  const Raster square{600, 600};
  const char* letters[] = {"9a", "9b", "9c"};
  const char* curves[] = {sphere, "1-r^2", "-tanh(r-1)"};
  for (int i = 0; i < 3; ++i) figures.push_back({letters[i], curves[i], cross_section(curve(curves[i]), square, studio.raster)});
}

void add_radii(const Studio& studio, std::vector<Figure>& figures) {
  figures.push_back({"10a", "clipped by 4:3", cross_section(curve("1-r^2"), studio.raster, studio.raster)});
  const double radii[] = {0.5, 1, 4.0 / 3, 5.0 / 3};
  const char* names[] = {"10b", "10c", "10d", "10e"};
  const char* captions[] = {"r_max 0.5", "r_max 1", "r_max 1.333", "r_max 1.666"};
  for (int i = 0; i < 4; ++i)
    figures.push_back({names[i], captions[i], panorama(studio, studio.scene("toys"), curve("1-r^2", std::nullopt, radii[i]), studio.samples)});
}

void add_samples(const Studio& studio, std::vector<Figure>& figures) {
  const Scene& toys = studio.scene("toys");
  figures.push_back({"11a", "equal lengths", cross_section(curve(sphere), {600, 600}, studio.raster, true)});
  const Pixels plain = panorama(studio, toys, curve(sphere), 1);
  const Crop rim{0.56, 0.56, 0.125, 0.125}, edge{0.66, 0.72, 0.125, 0.125};
  figures.push_back({"11b", "too few samples", enlarge(plain, rim)});
  RayTraceOptions rays = ray_options(studio.samples);
  rays.count_rays = true;
  const Frame fine = trace(studio, toys, curve(sphere), rays);
  figures.push_back({"12a", "spherical", mark(plain, edge)});
  figures.push_back({"12b", "enlarged", enlarge(plain, edge)});
  figures.push_back({"12c", "with samples", enlarge(colours(fine), edge)});
  figures.push_back({"12d", "where rays went", hot_spot_picture(fine, static_cast<std::uint16_t>(studio.samples + 1))});
  figures.push_back({"23a", "one ray a pixel", mark(plain, rim)});
  figures.push_back({"23b", "3 %, " + std::to_string(studio.samples) + " samples", mark(colours(fine), rim)});
  figures.push_back({"23b'", "enlarged", enlarge(colours(fine), rim)});
}

/// A bright square before a dark wall, less than half a pixel wide, between the centre and a corner of a pixel.
Scene make_speck(const Raster& raster) {
  Scene scene;
  const auto add = [&scene](const Vec3& centre, double half, const Vec4& colour) {
    Material material;
    material.base_color = colour;
    material.double_sided = material.unlit = true;
    scene.materials.push_back(material);
    Primitive quad;
    quad.material = static_cast<int>(scene.materials.size() - 1);
    for (const Vec2& corner : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)}) quad.positions.push_back(Vec3f(centre + half * Vec3(corner, 0)));
    quad.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back({"", {quad}});
    scene.instances.push_back({"", static_cast<int>(scene.meshes.size() - 1), Mat4(1)});
  };
  const double pixel = pixel_size(raster);
  add(Vec3(0, 0, -2), 8, Vec4(0.05, 0.06, 0.1, 1));
  add(Vec3(1.76 * pixel, 1.76 * pixel, -1), 0.23 * pixel, Vec4(1, 0.8, 0.2, 1)); // the centres are halves
  return scene;
}

void add_speck(std::vector<Figure>& figures, int samples) {
  const Raster raster{16, 12};
  const Scene scene = make_speck(raster);
  RayTraceOptions rays = ray_options(samples);
  for (const bool outlines : {false, true}) {
    rays.outlines = outlines;
    const Frame frame = ray_trace(scene, View{}, Surface(curve("1"), screen_radius(raster)), raster, rays);
    Pixels large{640, 480, {}};
    for (int y = 0; y < 480; ++y)
      for (int x = 0; x < 640; ++x) {
        const std::uint8_t* p = &frame.rgba[4 * std::size_t(y / 40 * 16 + x / 40)];
        large.rgba.insert(large.rgba.end(), p, p + 4);
      }
    figures.push_back({outlines ? "20b" : "20a", outlines ? "small object, found" : "by contrast: missed", std::move(large)});
  }
}

void add_curves(const Studio& studio, std::vector<Figure>& figures) {
  const char* curves[] = {"-r^3+r^2+r+1", folded_curve, sphere, "1-2.5*r^2"};
  const char* pictures[] = {"21a", "21b", "21c", "21d"};
  const char* sections[] = {"21e", "21f", "21g", "21h"};
  const char* captions[] = {"cubic", "folded, rays", "spherical", "parabolic"};
  for (int i = 0; i < 4; ++i) figures.push_back({pictures[i], captions[i], panorama(studio, studio.scene("toys"), curve(curves[i]), studio.samples)});
  for (int i = 0; i < 4; ++i) figures.push_back({sections[i], "its curve", cross_section(curve(curves[i]), studio.raster, studio.raster)});
}

} // namespace

Pixels panorama(const Studio& studio, const Scene& scene, const SurfaceOptions& surface, int samples) {
  return colours(trace(studio, scene, surface, ray_options(samples)));
}

std::vector<Figure> simulated(const Studio& studio, const std::string& number, const Pixels& picture, const SurfaceOptions& options) {
  const Surface surface(options, screen_radius({picture.width, picture.height}));
  EyeCamera camera;
  camera.raster = studio.raster;
  camera.look = Vec3(0.35, -0.1, -1);
  const Pixels seen = simulate(picture, surface, camera, {PictureFilter::nearest, 16});
  return {{number + "b", "on the display", outside_view(picture, surface, camera, studio.raster)},
          {number + "c", "seen from the eye", seen},
          {number + "d", "enlarged", enlarge(seen, {0.45, 0.5, 0.25, 0.25})}};
}

std::vector<Figure> ray_figures(const Studio& studio, const Progress& progress) {
  std::vector<Figure> figures;
  tell(progress, "figures 9, 10", 0);
  add_surfaces(studio, figures);
  add_radii(studio, figures);
  tell(progress, "figures 11, 12, 20, 23", 0.1);
  add_samples(studio, figures);
  add_speck(figures, studio.samples);
  tell(progress, "figures 21, 22", 0.25);
  add_curves(studio, figures);
  const SurfaceOptions display = curve(hyperbola, 5);
  const Pixels picture = panorama(studio, studio.scene("toys"), display, studio.samples);
  figures.push_back({"22a", "hyperbolic, d = -5", picture});
  for (Figure& figure : simulated(studio, "22", picture, display)) figures.push_back(std::move(figure));
  return figures;
}

} // namespace domewarp
