// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/convert.h"
#include "domewarp/render/compare_pictures.h"
#include "domewarp/render/rasterise.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/render/simulate.h"
#include "figures.h"

namespace domewarp {

namespace {

/// Both renderers, without a projector and with one far and near.
void add_projectors(const Studio& studio, std::vector<Figure>& figures) {
  const std::string f = "2-(r+0.01)^r";
  const std::optional<double> projectors[] = {std::nullopt, 1.0, 0.25};
  const char* names[] = {"19a", "19b", "19c", "19d", "19e", "19f"};
  const char* captions[] = {"no projector", "d = -1", "d = -0.25"};
  const Scene& toys = studio.scene("toys");
  for (int i = 0; i < 3; ++i)
    figures.push_back({names[i], std::string("rays, ") + captions[i], panorama(studio, toys, curve(f, projectors[i]), studio.samples)});
  for (int i = 0; i < 3; ++i)
    figures.push_back({names[i + 3], std::string("points, ") + captions[i], warped_panorama(studio, toys, curve(f, projectors[i]))});
}

void add_scenes(const Studio& studio, std::vector<Figure>& figures) {
  const char* names[] = {"24a", "24b", "24c", "24d", "24e"};
  const char* scenes[] = {"cubes", "pool", "hardware", "toys", "biology"};
  EyeCamera camera;
  camera.fov_deg = 75;
  camera.raster = studio.raster;
  RayTraceOptions rays;
  rays.samples = studio.samples;
  rays.layers = Layers::colours;
  for (int i = 0; i < 5; ++i) {
    const Scene& scene = studio.scene(scenes[i]);
    const View view = turn_view(resolve_view(scene, {}), camera);
    figures.push_back({names[i], scenes[i], colours(ray_trace(scene, view, flat_surface(camera), camera.raster, rays))});
  }
}

void add_subdivision(const Studio& studio, std::vector<Figure>& figures) {
  const Scene& toys = studio.scene("toys");
  figures.push_back({"27a", "1-r^2", warped_panorama(studio, toys, curve("1-r^2"), false, true)});
  figures.push_back({"27b", "-log(r+0.1)", warped_panorama(studio, toys, curve("-log(r+0.1)"), false, true)});
  figures.push_back({"27c", "1-r^2", warped_panorama(studio, toys, curve("1-r^2"))});
  figures.push_back({"27d", "1-2r", warped_panorama(studio, toys, curve("1-2*r"))});
  figures.push_back({"27c'", "the thesis' scheme", warped_panorama(studio, toys, curve("1-r^2"), true)});
}

} // namespace

Pixels warped_panorama(const Studio& studio, const Scene& scene, const SurfaceOptions& surface, bool isotropic, bool wireframe) {
  ConvertOptions options;
  options.surface = surface;
  options.raster = studio.raster;
  options.refine.source_attributes = true; // the light at the eye needs to know where a vertex came from
  if (isotropic) options.refine.subdivision = Subdivision::isotropic;
  ConvertReport report;
  const Scene warped = convert(scene, options, report);
  RasterOptions raster;
  raster.supersample = wireframe ? 1 : 4;
  if (isotropic) raster.background = {255, 0, 255, 255}; // cracks show
  const Frame frame = rasterise(warped, studio.raster, raster);
  return wireframe ? wireframe_picture(frame, make_screen(warped, studio.raster)) : colours(frame);
}

std::vector<Figure> point_figures(const Studio& studio, const Progress& progress) {
  std::vector<Figure> figures;
  tell(progress, "figure 19", 0.5);
  add_projectors(studio, figures);
  figures.push_back({"21b'", "folded, points", warped_panorama(studio, studio.scene("toys"), curve(folded_curve))});
  tell(progress, "figure 24", 0.65);
  add_scenes(studio, figures);
  tell(progress, "figure 27", 0.8);
  add_subdivision(studio, figures);
  tell(progress, "figure 28", 0.9);
  const SurfaceOptions display = curve("3-sqrt(4+6*r^2)", 5);
  const Pixels picture = warped_panorama(studio, studio.scene("toys"), display);
  figures.push_back({"28a", "hyperbolic, points", picture});
  for (Figure& figure : simulated(studio, "28", picture, display)) figures.push_back(std::move(figure));
  figures.pop_back(); // the thesis has no 28d
  return figures;
}

} // namespace domewarp
