// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/memory_estimate.h"

#include <cmath>

namespace domewarp {

namespace {

std::string mib(double bytes) { return std::to_string(std::llround(std::ceil(bytes / (1 << 20)))) + " MiB"; }

} // namespace

double estimate_memory(const FileSurvey& survey, const ConvertOptions& options) {
  // Measured by the smallest RLIMIT_DATA that three scenes of 5,000 to 115,000 triangles are converted in, none of them split:
  // the file and its decoded attributes are held once each while reading; then come welding, topology, the refined mesh and
  // the written file. Embree takes its threads' stacks, triangles and a tree.
  constexpr double program = 32 << 20, bytes_per_triangle = 250;
  constexpr double ray_tracer = 110 << 20, bytes_per_ray_triangle = 230;
  const double plain = program + survey.file_bytes + survey.decoded_bytes + bytes_per_triangle * survey.drawn_triangles;
  const bool traces_rays = options.shading == Shading::bake || options.cull_hidden;
  return traces_rays ? plain + ray_tracer + bytes_per_ray_triangle * survey.drawn_triangles : plain;
}

std::string memory_refusal(double estimate, std::uint64_t max_memory) {
  const auto limit = static_cast<double>(max_memory);
  return max_memory == 0 || estimate <= limit ? "" : "needs about " + mib(estimate) + ", --max-memory allows " + mib(limit);
}

std::string memory_exhausted(std::uint64_t max_memory) {
  return "needs more memory than " + (max_memory > 0 ? "--max-memory allows, " + mib(static_cast<double>(max_memory)) : "there is");
}

} // namespace domewarp
