// SPDX-License-Identifier: Apache-2.0
//
// Based on: the attenuation of KHR_lights_punctual (range window, inner and outer cone).
#include "domewarp/render/lights.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace domewarp {

namespace {

double falloff(const PlacedLight& light, double distance) {
  const double square = 1 / (distance * distance);
  if (!(light.range > 0)) return square;
  const double ratio = distance / light.range;
  return square * std::clamp(1 - ratio * ratio * ratio * ratio, 0.0, 1.0);
}

double cone(const PlacedLight& light, const Vec3& towards) {
  const double edge = std::clamp(-glm::dot(light.direction, towards) * light.cone_scale + light.cone_offset, 0.0, 1.0);
  return edge * edge;
}

PlacedLight place(const Light& light, const Mat4& from_world) {
  PlacedLight placed;
  placed.kind = light.kind;
  placed.position = Vec3(from_world * light.world[3]);
  const Vec3 direction = -Vec3(from_world * light.world[2]);
  if (glm::length(direction) > 0) placed.direction = glm::normalize(direction);
  placed.strength = light.intensity * light.color;
  placed.range = light.range;
  if (light.kind == LightKind::spot) {
    placed.cone_scale = 1 / std::max(0.001, std::cos(light.inner_cone) - std::cos(light.outer_cone));
    placed.cone_offset = -std::cos(light.outer_cone) * placed.cone_scale;
  }
  return placed;
}

} // namespace

std::vector<PlacedLight> place_lights(const Scene& scene, const Mat4& from_world) {
  std::vector<PlacedLight> lights;
  for (const Light& light : scene.lights) lights.push_back(place(light, from_world));
  return lights;
}

Arrival arrival(const PlacedLight& light, const Vec3& point) {
  Arrival result;
  if (light.kind == LightKind::directional) {
    result.towards = -light.direction;
    result.irradiance = light.strength;
    return result;
  }
  const Vec3 path = light.position - point;
  result.distance = glm::length(path);
  if (!(result.distance > 0)) return result;
  result.towards = path / result.distance;
  result.irradiance = falloff(light, result.distance) * cone(light, result.towards) * light.strength;
  return result;
}

} // namespace domewarp
