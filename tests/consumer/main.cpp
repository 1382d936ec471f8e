// SPDX-License-Identifier: Apache-2.0
// Usage: consumer IN.glb OUT.glb. The library examples of the README: a conversion, and live use.
#include <iostream>
#include <vector>

#include <domewarp/convert/convert.h>
#include <domewarp/convert/live.h>
#include <domewarp/core/errors.h>
#include <domewarp/gltf/read.h>
#include <domewarp/gltf/write.h>

using namespace domewarp;

/// How many of a scene's vertices an eye at its first camera sees, warped live.
std::size_t visible_vertices(const Scene& scene, const ConvertOptions& options) {
  const LiveMesh mesh = make_live_mesh(scene);
  const BatchMap map(Surface(options.surface, screen_radius(options.raster)));
  std::vector<Vec3f> positions(mesh.positions.size());
  rewarp(mesh, resolve_view(scene, options.view), map, BatchOutput::image, positions);
  std::size_t count = 0;
  for (const Vec3f& p : positions) count += p.x * p.x + p.y * p.y <= 1;
  return count;
}

int main(int count, char** arguments) try {
  if (count != 3) return 1;
  ConvertOptions options;
  options.surface.lens = Lens::equidistant;
  options.surface.fov_deg = 200;
  options.raster = {2048, 2048};
  ConvertReport report;
  const Scene scene = read_scene(arguments[1]);
  write_scene(convert(scene, options, report), arguments[2]);
  std::cout << report.refine.triangles_out << " triangles, at most " << report.refine.error_px_max << " px off\n";
  const std::size_t visible = visible_vertices(scene, options);
  std::cout << visible << " of the scene's vertices are in the picture\n";
  return is_kept(report, options) && visible > 0 ? 0 : 3;
} catch (const Error& error) {
  std::cerr << error.what() << "\n";
  return static_cast<int>(error.code());
}
