// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/memory_estimate.h"

#include <cmath>

namespace domewarp {

namespace {

std::string mib(double bytes) { return std::to_string(std::llround(std::ceil(bytes / (1 << 20)))) + " MiB"; }

} // namespace

double estimate_memory(const FileSurvey& survey, const ConvertOptions& options) {
  // Measured by the smallest RLIMIT_DATA that scenes are converted in, none of their triangles split: the file and its decoded
  // attributes are held once each while reading; then come welding, the mapped points and the written file (132 MiB for 10^6
  // triangles that share their vertices). Embree takes its threads' stacks, triangles and a tree. Textures are unpacked to
  // four bytes a pixel.
  constexpr double program = 32 << 20, bytes_per_triangle = 50;
  constexpr double ray_tracer = 110 << 20, bytes_per_ray_triangle = 230, bytes_per_pixel = 4;
  const double plain = program + survey.file_bytes + survey.decoded_bytes + bytes_per_triangle * survey.drawn_triangles;
  const bool traces_rays = options.shading == Shading::bake || options.cull_hidden;
  return traces_rays ? plain + ray_tracer + bytes_per_ray_triangle * survey.drawn_triangles + bytes_per_pixel * survey.texture_pixels : plain;
}

std::string memory_refusal(double estimate, std::uint64_t max_memory) {
  const auto limit = static_cast<double>(max_memory);
  return max_memory == 0 || estimate <= limit ? "" : "needs about " + mib(estimate) + ", --max-memory allows " + mib(limit);
}

std::string memory_exhausted(std::uint64_t max_memory) {
  return "needs more memory than " + (max_memory > 0 ? "--max-memory allows, " + mib(static_cast<double>(max_memory)) : "there is");
}

} // namespace domewarp
