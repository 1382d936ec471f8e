// SPDX-License-Identifier: Apache-2.0
// Usage: consumer IN.glb OUT.glb. The library example of the README.
#include <iostream>

#include <domewarp/convert/convert.h>
#include <domewarp/core/errors.h>
#include <domewarp/gltf/read.h>
#include <domewarp/gltf/write.h>

int main(int count, char** arguments) try {
  if (count != 3) return 1;
  domewarp::ConvertOptions options;
  options.surface.lens = domewarp::Lens::equidistant;
  options.surface.fov_deg = 200;
  options.raster = {2048, 2048};
  domewarp::ConvertReport report;
  const domewarp::Scene scene = domewarp::read_scene(arguments[1]);
  domewarp::write_scene(domewarp::convert(scene, options, report), arguments[2]);
  std::cout << report.refine.triangles_out << " triangles, at most " << report.refine.error_px_max << " px off\n";
  return domewarp::is_kept(report, options) ? 0 : 3;
} catch (const domewarp::Error& error) {
  std::cerr << error.what() << "\n";
  return static_cast<int>(error.code());
}
