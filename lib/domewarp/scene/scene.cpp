// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/scene.h"

#include <cmath>

#include <glm/common.hpp>

#include "domewarp/scene/view.h"

namespace domewarp {

std::size_t count_triangles(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
      if (primitive.topology == Topology::triangles) count += primitive.indices.size() / 3;
  return count;
}

std::size_t count_vertices(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives) count += primitive.positions.size();
  return count;
}

const Attribute* find_attribute(const Primitive& primitive, const std::string& name) {
  for (const Attribute& attribute : primitive.attributes)
    if (attribute.name == name) return &attribute;
  return nullptr;
}

std::optional<Box> bounding_box(const Scene& scene) {
  std::optional<Box> box;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
      for (const std::uint32_t index : primitive.indices) {
        const Vec3 p = to_world(instance.world, primitive.positions[index]);
        if (!std::isfinite(p.x + p.y + p.z)) continue;
        if (!box) box = Box{p, p};
        box->low = glm::min(box->low, p);
        box->high = glm::max(box->high, p);
      }
  return box;
}

} // namespace domewarp
