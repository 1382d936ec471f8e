// SPDX-License-Identifier: Apache-2.0
#include "mesh_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "domewarp/scene/view.h"

namespace domewarp::checks {

namespace {

using Key = std::array<double, 3>;
Key key(const Vec3& p) {
  return {p.x, p.y, p.z};
}

void append(std::vector<Triangle>& triangles, const Primitive& primitive, const Mat4& world) {
  for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = to_world(world, primitive.positions[primitive.indices[i + k]]);
    triangles.push_back(t);
  }
}

} // namespace

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (const Primitive& primitive : mesh.primitives) append(triangles, primitive, Mat4(1));
  return triangles;
}

std::vector<Triangle> triangles_of(const Scene& scene) {
  std::vector<Triangle> triangles;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
      append(triangles, primitive, instance.world);
  return triangles;
}

EdgeUse count_edge_uses(const std::vector<Triangle>& triangles) {
  std::map<std::array<Key, 2>, int> uses;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[{key(t[k]), key(t[(k + 1) % 3])}];
  EdgeUse result;
  for (const auto& [edge, count] : uses) {
    if (count > 1) ++result.crowded;
    if (!uses.contains({edge[1], edge[0]})) ++result.open;
  }
  return result;
}

int count_t_junctions(const std::vector<Triangle>& triangles, double tolerance) {
  std::set<Key> corners;
  std::set<std::array<Key, 2>> sides;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      corners.insert(key(t[k]));
      const Key a = key(t[k]), b = key(t[(k + 1) % 3]);
      sides.insert({std::min(a, b), std::max(a, b)});
    }
  int count = 0;
  for (const auto& [from, to] : sides) {
    const Vec3 a(from[0], from[1], from[2]), d = Vec3(to[0], to[1], to[2]) - a;
    const double length = glm::length(d);
    // Corners are sorted by x: only those within the side's reach can touch it.
    for (auto it = corners.lower_bound({from[0] - tolerance, -HUGE_VAL, -HUGE_VAL});
         it != corners.end() && (*it)[0] <= to[0] + tolerance; ++it) {
      const Vec3 p = Vec3((*it)[0], (*it)[1], (*it)[2]) - a;
      const double along = glm::dot(p, d) / length;
      if (along <= tolerance || along >= length - tolerance) continue;
      if (glm::length(p - d * (along / length)) <= tolerance) ++count;
    }
  }
  return count;
}

namespace {

struct Placed {
  Triangle corners;
  Vec3 normal, low, high;
};

Placed place(const Triangle& t) {
  const Vec3 n = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
  return {t, n, glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2]))};
}

bool lies_in_plane(const Placed& a, const Placed& b, double tolerance) {
  return std::all_of(b.corners.begin(), b.corners.end(),
                     [&](const Vec3& p) { return std::abs(glm::dot(a.normal, p - a.corners[0])) <= tolerance; });
}

/// Whether a line along a side of `a` parts the two, which lie in one plane. A shared strip of `tolerance` counts as
/// parted.
bool is_parted(const Placed& a, const Placed& b, double tolerance) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 outward = glm::normalize(glm::cross(a.corners[(k + 1) % 3] - a.corners[k], a.normal));
    const auto outside = [&](const Vec3& p) { return glm::dot(outward, p - a.corners[k]) >= -tolerance; };
    if (std::all_of(b.corners.begin(), b.corners.end(), outside)) return true;
  }
  return false;
}

} // namespace

int count_overlaps(const std::vector<Triangle>& triangles, double tolerance) {
  std::vector<Placed> placed;
  for (const Triangle& t : triangles) placed.push_back(place(t));
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) { return a.low.x < b.low.x; });
  int count = 0;
  for (std::size_t i = 0; i < placed.size(); ++i)
    for (std::size_t j = i + 1; j < placed.size() && placed[j].low.x <= placed[i].high.x + tolerance; ++j) {
      const Placed &a = placed[i], &b = placed[j];
      if (a.low.y > b.high.y + tolerance || b.low.y > a.high.y + tolerance || a.low.z > b.high.z + tolerance ||
          b.low.z > a.high.z + tolerance)
        continue;
      if (!lies_in_plane(a, b, tolerance) || !lies_in_plane(b, a, tolerance)) continue;
      if (!is_parted(a, b, tolerance) && !is_parted(b, a, tolerance)) ++count;
    }
  return count;
}

double smallest_height(const Triangle& t) {
  const double longest = std::max({glm::length(t[1] - t[0]), glm::length(t[2] - t[1]), glm::length(t[0] - t[2])});
  return longest > 0 ? glm::length(glm::cross(t[1] - t[0], t[2] - t[0])) / longest : 0;
}

double signed_volume(const std::vector<Triangle>& triangles) {
  double volume = 0;
  for (const Triangle& t : triangles) volume += glm::dot(t[0], glm::cross(t[1], t[2]));
  return volume;
}

double cast(const std::vector<Triangle>& triangles, const Vec3& origin, const Vec3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : triangles) {
    const Vec3 e = t[1] - t[0], f = t[2] - t[0], n = glm::cross(e, f), o = origin - t[0];
    const double facing = -glm::dot(direction, n);
    if (!(facing > 0)) continue;
    const Vec3 q = glm::cross(o, direction);
    const double u = glm::dot(f, q), v = -glm::dot(e, q), distance = glm::dot(o, n) / facing;
    if (u >= 0 && v >= 0 && u + v <= facing && distance > 0) nearest = std::min(nearest, distance);
  }
  return nearest;
}

} // namespace domewarp::checks
