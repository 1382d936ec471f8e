// SPDX-License-Identifier: Apache-2.0
// Based on: the hierarchical z-buffer of Greene, Kass and Miller 1993, filled by rays.
#include "domewarp/convert/hidden.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "domewarp/render/ray_trace.h"

namespace domewarp {

namespace {

constexpr double rounding = 1e-6;    ///< relative, of the float32 depths
constexpr int most_cells = 8;        ///< looked at along each axis of a box

/// What can hide something: the scene without its blended primitives.
Scene opaque_part(const Scene& scene) {
  Scene opaque = scene;
  for (Mesh& mesh : opaque.meshes)
    for (Primitive& primitive : mesh.primitives)
      if (primitive.material >= 0 && scene.materials[static_cast<std::size_t>(primitive.material)].alpha_mode == AlphaMode::blend)
        primitive.indices.clear();
  return opaque;
}

} // namespace

SeenDepths::SeenDepths(const Scene& scene, const View& view, const Surface& surface, const Raster& raster) : raster_(raster) {
  Level finest{raster.width, raster.height, std::vector<float>(std::size_t(raster.width) * std::size_t(raster.height), 0)};
  RayTraceOptions options;
  options.unlit = true;
  ray_trace(opaque_part(scene), view, surface, {2 * raster.width, 2 * raster.height}, options, [&](const Frame& rows, int top) {
    for (int y = 0; y < rows.height; ++y)
      for (int x = 0; x < rows.width; ++x) {
        const float depth = rows.depth[std::size_t(y) * std::size_t(rows.width) + std::size_t(x)];
        float& cell = finest.farthest[std::size_t((top + y) / 2) * std::size_t(raster.width) + std::size_t(x / 2)];
        cell = std::max(cell, std::isnan(depth) ? std::numeric_limits<float>::infinity() : depth);
      }
  });
  levels_.push_back(std::move(finest));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    coarse.farthest.assign(std::size_t(coarse.width) * std::size_t(coarse.height), 0);
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x) {
        float& cell = coarse.farthest[std::size_t(y / 2) * std::size_t(coarse.width) + std::size_t(x / 2)];
        cell = std::max(cell, fine.farthest[std::size_t(y) * std::size_t(fine.width) + std::size_t(x)]);
      }
    levels_.push_back(std::move(coarse));
  }
}

bool SeenDepths::is_hidden(const Vec2& low, const Vec2& high, double margin, double nearest) const {
  const double px = pixel_size(raster_);
  const auto column = [&](double x) { return std::floor(std::clamp(x / px + 0.5 * raster_.width, -1e9, 1e9)); };
  const auto row = [&](double y) { return std::floor(std::clamp(0.5 * raster_.height - y / px, -1e9, 1e9)); };
  const double left = column(low.x - margin), right = column(high.x + margin), top = row(high.y + margin), bottom = row(low.y - margin);
  if (!(right >= 0 && left < raster_.width && bottom >= 0 && top < raster_.height)) return false;
  const float farthest = farthest_within(static_cast<int>(std::max(left, 0.0)), static_cast<int>(std::max(top, 0.0)),
                                         static_cast<int>(std::min(right, raster_.width - 1.0)), static_cast<int>(std::min(bottom, raster_.height - 1.0)));
  return farthest < nearest * (1 - rounding);
}

float SeenDepths::farthest_within(int left, int top, int right, int bottom) const {
  std::size_t level = 0;
  while (std::max(right - left, bottom - top) >= most_cells && level + 1 < levels_.size()) {
    left /= 2, top /= 2, right /= 2, bottom /= 2;
    ++level;
  }
  const Level& cells = levels_[level];
  float farthest = 0;
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) farthest = std::max(farthest, cells.farthest[std::size_t(y) * std::size_t(cells.width) + std::size_t(x)]);
  return farthest;
}

} // namespace domewarp
