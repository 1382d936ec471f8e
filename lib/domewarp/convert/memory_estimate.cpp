// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/memory_estimate.h"

namespace domewarp {

double estimate_memory(const FileSurvey& survey) {
  // Measured: the file and its decoded attributes are held once each while reading; welding, topology, the refined mesh and
  // the written file take what one triangle that is not split takes.
  constexpr double program = 32 << 20, bytes_per_triangle = 500;
  return program + survey.file_bytes + survey.decoded_bytes + bytes_per_triangle * survey.drawn_triangles;
}

} // namespace domewarp
