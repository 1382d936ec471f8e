// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/packing_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace domewarp {

namespace {

double moved(const Vec3f& position, double by, Projection projection) {
  if (projection == Projection::orthographic) return by;
  const double depth = -static_cast<double>(position.z);
  if (!(depth > by)) return std::numeric_limits<double>::infinity();
  const double x = position.x / depth, y = position.y / depth;
  return by * std::sqrt(1 + x * x + y * y) / (depth - by);
}

} // namespace

double packing_error_px(const Scene& warped, const WriteOptions& write, Projection projection, const Raster& raster) {
  const double by = std::sqrt(3.0) * packing_error(warped, write);
  if (by == 0) return 0;
  double largest = 0;
  for (const Mesh& mesh : warped.meshes)
    for (const Primitive& primitive : mesh.primitives)
      for (const Vec3f& position : primitive.positions) largest = std::max(largest, moved(position, by, projection));
  return largest / pixel_size(raster);
}

} // namespace domewarp
