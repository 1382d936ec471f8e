// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/ray_shade.h"

#include <numeric>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace domewarp {

namespace {

constexpr int most_layers = 128;

/// Less light than this cannot change an 8-bit picture.
constexpr double opaque_enough = 1e-4;

/// Shadow rays begin and end this share of the distance to the eye away from a surface.
constexpr double shadow_gap = 2e-5;

/// World normals go with the cofactor matrix, which exists for singular matrices too; shading turns them to the seen
/// side.
Vec3 normal_of(const RayWorld& world, const RayHit& hit, const Vec3& face) {
  if (!hit.part->normal) return face;
  const Mat3 m(hit.part->world);
  const Mat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  const Vec3 n = cofactor * Vec3(interpolate(hit.part->normal, hit, Vec4(0)));
  return {glm::dot(world.view.right, n), glm::dot(world.view.up, n), glm::dot(world.view.back, n)};
}

/// Lights that reach a point; one that is blocked gives nothing. Counts the rays.
Vec3 shadowed_light(const RayWorld& world, const SurfacePoint& point, unsigned& rays) {
  Vec3 sum(0);
  const double gap = shadow_gap * glm::length(point.position);
  for (const PlacedLight& light : *world.lighting.lights) {
    const Arrival arriving = arrival(light, point.position);
    const Vec3 light_here = diffuse(point, arriving);
    if (light_here == Vec3(0)) continue;
    ++rays;
    if (!world.geometry.is_blocked(point.position, arriving.towards, gap, arriving.distance - gap)) sum += light_here;
  }
  return world.lighting.exposure * sum;
}

Vec4 shade_hit(const RayWorld& world, const RayHit& hit, unsigned& rays) {
  const SurfacePoint point = surface_point(world, hit);
  const Look& look = *hit.part->look;
  return shade(look, point, light_at(world, look, point, rays));
}

} // namespace

Vec3 light_at(const RayWorld& world, const Look& look, const SurfacePoint& point, unsigned& rays) {
  const bool shadowed = world.shadows && world.lighting.lights && !is_unlit(look, world.lighting);
  return shadowed ? shadowed_light(world, point, rays) : light_at(look, point, world.lighting);
}

SurfacePoint surface_point(const RayWorld& world, const RayHit& hit) {
  const Vec3 corners[3] = {world.geometry.corner(hit, 0), world.geometry.corner(hit, 1), world.geometry.corner(hit, 2)};
  const Look& look = *hit.part->look;
  SurfacePoint point;
  point.position = hit.weights[0] * corners[0] + hit.weights[1] * corners[1] + hit.weights[2] * corners[2];
  point.face = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  point.normal = normal_of(world, hit, point.face);
  point.color = interpolate(hit.part->color, hit, Vec4(1));
  point.base_uv = transform_uv(look.base, Vec2(interpolate(hit.part->base_uv, hit, Vec4(0))));
  point.glow_uv = transform_uv(look.glow, Vec2(interpolate(hit.part->glow_uv, hit, Vec4(0))));
  return point;
}

void trace(const RayWorld& world, std::span<const Vec3> directions, RaySample* samples) {
  Ray rays[RayGeometry::packet_size];
  RayHit hits[RayGeometry::packet_size], previous[RayGeometry::packet_size];
  std::size_t sample_of[RayGeometry::packet_size];
  std::size_t count = directions.size();
  for (std::size_t i = 0; i < count; ++i) rays[i] = {directions[i], world.near, nullptr};
  std::iota(sample_of, sample_of + count, std::size_t{0});
  for (int layer = 0; layer < most_layers && count > 0; ++layer) {
    world.geometry.first_hits({rays, count}, hits);
    std::size_t going_on = 0;
    for (std::size_t i = 0; i < count; ++i) {
      RaySample& sample = samples[sample_of[i]];
      ++sample.rays;
      if (!hits[i].part) continue;
      if (layer == 0) sample.first = hits[i];
      const Vec4 colour = shade_hit(world, hits[i], sample.rays);
      sample.light += (1 - sample.light.a) * colour.a * Vec4(Vec3(colour), 1);
      if (sample.light.a >= 1 - opaque_enough) continue;
      previous[going_on] = hits[i];
      rays[going_on] = {rays[i].direction, world.near, &previous[going_on]};
      sample_of[going_on++] = sample_of[i];
    }
    count = going_on;
  }
}

} // namespace domewarp
