// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/ray_trace.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/render/parts.h"
#include "domewarp/render/ray_geometry.h"
#include "domewarp/render/shading.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

namespace {

constexpr int tile_size = 32;
constexpr int most_layers = 128;

/// Less light than this cannot change an 8-bit picture.
constexpr double opaque_enough = 1e-4;

struct Job {
  const View& view;
  const Surface& surface;
  const Raster& raster;
  const RayTraceOptions& options;
  const RayGeometry& geometry;
  Frame& frame;
};

Vec3 point_of(const RayGeometry& geometry, const RayHit& hit) {
  Vec3 p(0);
  for (int i = 0; i < 3; ++i) p += hit.weights[i] * geometry.corner(hit, i);
  return p;
}

/// World normals go with the cofactor matrix, which exists for singular matrices too; the sign does not matter here.
Vec3 normal_of(const Job& job, const RayHit& hit) {
  if (hit.part->normal) {
    const Mat3 m(hit.part->world);
    const Mat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    const Vec3 n = cofactor * Vec3(interpolate(hit.part->normal, hit, Vec4(0)));
    return {glm::dot(job.view.right, n), glm::dot(job.view.up, n), glm::dot(job.view.back, n)};
  }
  const Vec3& v0 = job.geometry.corner(hit, 0);
  return glm::cross(job.geometry.corner(hit, 1) - v0, job.geometry.corner(hit, 2) - v0);
}

Vec4 shade_hit(const Job& job, const RayHit& hit) {
  const Look& look = *hit.part->look;
  SurfacePoint point;
  point.position = point_of(job.geometry, hit);
  point.normal = normal_of(job, hit);
  point.color = interpolate(hit.part->color, hit, Vec4(1));
  point.base_uv = transform_uv(look.base, Vec2(interpolate(hit.part->base_uv, hit, Vec4(0))));
  point.glow_uv = transform_uv(look.glow, Vec2(interpolate(hit.part->glow_uv, hit, Vec4(0))));
  return shade(look, point, job.options.unlit);
}

void note_hit(const Job& job, const RayHit& hit, std::size_t pixel) {
  const Vec3 p = point_of(job.geometry, hit);
  job.frame.position[pixel] = Vec3f(p);
  job.frame.depth[pixel] = static_cast<float>(glm::length(p));
  job.frame.object[pixel] = hit.part->object;
  job.frame.triangle[pixel] = hit.part->first_triangle + hit.triangle + 1;
}

/// Light along a ray, front to back, multiplied by alpha; notes the nearest hit.
Vec4 trace(const Job& job, const Vec3& direction, std::size_t pixel) {
  Vec4 light(0);
  RayHit hit, previous;
  for (int layer = 0; layer < most_layers && light.a < 1 - opaque_enough; ++layer) {
    if (!job.geometry.first_hit(direction, job.options.near, layer ? &previous : nullptr, hit)) break;
    if (layer == 0) note_hit(job, hit, pixel);
    const Vec4 colour = shade_hit(job, hit);
    light += (1 - light.a) * colour.a * Vec4(Vec3(colour), 1);
    previous = hit;
  }
  return light;
}

void trace_tile(const Job& job, int left, int top) {
  for (int row = top; row < std::min(top + tile_size, job.raster.height); ++row)
    for (int column = left; column < std::min(left + tile_size, job.raster.width); ++column) {
      const std::size_t pixel = std::size_t(row) * std::size_t(job.raster.width) + std::size_t(column);
      Vec3 direction;
      Vec4 light(0);
      if (unproject(job.surface, pixel_centre(job.raster, column, row), direction))
        light = trace(job, direction, pixel);
      const auto colour = resolve_pixel(light, job.options.background);
      std::copy(colour.begin(), colour.end(), &job.frame.rgba[4 * pixel]);
    }
}

} // namespace

Frame ray_trace(const Scene& scene, const View& view, const Surface& surface, const Raster& raster,
                const RayTraceOptions& options) {
  Frame frame = make_frame(raster.width, raster.height);
  frame.renderer = "Embree";
  const Parts parts = prepare_parts(scene);
  frame.warnings = parts.warnings;
  const RayGeometry geometry(parts, view, options.embree);
  const Job job{view, surface, raster, options, geometry, frame};
  const int across = (raster.width + tile_size - 1) / tile_size, down = (raster.height + tile_size - 1) / tile_size;
  parallel_each(std::size_t(across) * std::size_t(down), 1, [&](std::size_t i) {
    trace_tile(job, static_cast<int>(i % std::size_t(across)) * tile_size,
               static_cast<int>(i / std::size_t(across)) * tile_size);
  });
  return frame;
}

} // namespace domewarp
