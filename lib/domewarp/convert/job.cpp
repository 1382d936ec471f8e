// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/job.h"

namespace domewarp {

ConvertReport run_job(const std::filesystem::path& input, const std::filesystem::path& output, const JobOptions& options,
                      DisplayCache* displays, const Progress& progress) {
  tell(progress, "read");
  Scene scene = read_scene(input, options.read);
  if (!scene.extras.empty()) scene.warnings.push_back("is warped already, and is warped once more");
  ConvertReport report;
  Scene warped;
  if (displays != nullptr) {
    const auto display = displays->find(options.convert.surface, options.convert.raster, options.convert.method);
    warped = convert(scene, options.convert, *display, report, progress);
  } else {
    warped = convert(scene, options.convert, report, progress);
  }
  scene = {};
  tell(progress, "write");
  write_scene(warped, output, options.write);
  return report;
}

} // namespace domewarp
