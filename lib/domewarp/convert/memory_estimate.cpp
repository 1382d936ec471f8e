// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/memory_estimate.h"

namespace domewarp {

namespace {

std::string mib(double bytes) { return std::to_string(static_cast<long long>(bytes / (1 << 20))) + " MiB"; }

} // namespace

double estimate_memory(const FileSurvey& survey, const ConvertOptions& options) {
  // Measured: the file and its decoded attributes are held once each while reading; welding, topology, the refined mesh and
  // the written file take what one triangle that is not split takes. Embree's triangles and tree come on top.
  constexpr double program = 32 << 20, bytes_per_triangle = 500, bytes_per_ray_triangle = 150;
  const bool traces_rays = options.shading == Shading::bake || options.cull_hidden;
  return program + survey.file_bytes + survey.decoded_bytes +
         (bytes_per_triangle + (traces_rays ? bytes_per_ray_triangle : 0)) * survey.drawn_triangles;
}

std::string memory_refusal(double estimate, std::uint64_t max_memory) {
  const auto limit = static_cast<double>(max_memory);
  return max_memory == 0 || estimate <= limit ? "" : "needs about " + mib(estimate) + ", --max-memory allows " + mib(limit);
}

std::string memory_exhausted(std::uint64_t max_memory) {
  return "needs more memory than " + (max_memory > 0 ? "--max-memory allows, " + mib(static_cast<double>(max_memory)) : "there is");
}

} // namespace domewarp
