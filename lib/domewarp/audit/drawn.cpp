// SPDX-License-Identifier: GPL-3.0-or-later
#include "domewarp/audit/drawn.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

template <typename Visit>
void for_each_primitive(const Scene& scene, Visit&& visit) {
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
      if (primitive.topology == Topology::triangles) visit(instance, primitive);
}

/// Positions of _SOURCE_POSITION, or nothing when a primitive lacks it.
std::vector<Vec3> source_attribute(const Scene& scene) {
  std::vector<Vec3> source;
  bool complete = true;
  for_each_primitive(scene, [&](const Instance&, const Primitive& primitive) {
    const Attribute* attribute = find_attribute(primitive, "_SOURCE_POSITION");
    complete = complete && attribute != nullptr && attribute->components == 3;
    if (!complete) return;
    for (std::size_t v = 0; v < primitive.positions.size(); ++v)
      source.push_back(Vec3(attribute->values[3 * v], attribute->values[3 * v + 1], attribute->values[3 * v + 2]) + Vec3(0.0));
  });
  if (!complete) source.clear();
  return source;
}

/// A vertex belongs to the branch on whose ring the middle of its triangles lies.
std::vector<std::uint32_t> find_branches(const Drawn& drawn, const Picture& picture) {
  std::vector<std::uint32_t> branch(drawn.position.size(), 0);
  if (picture.surface.branches().size() == 1) return branch;
  for (const Corners& t : drawn.triangles) {
    Vec2 middle(0);
    for (const std::uint32_t v : t) middle += drawn_at(drawn.position[v], picture.perspective) / 3.0;
    for (const std::uint32_t v : t) branch[v] = static_cast<std::uint32_t>(picture.surface.branch_at(glm::length(middle)));
  }
  return branch;
}

auto key(const Vec3& p, std::uint32_t tag) { return std::tuple(p.x, p.y, p.z, tag); }

} // namespace

Drawn collect_drawn(const Scene& scene) {
  Drawn drawn;
  for_each_primitive(scene, [&](const Instance& instance, const Primitive& primitive) {
    const auto first = static_cast<std::uint32_t>(drawn.position.size());
    for (const Vec3f& p : primitive.positions) drawn.position.push_back(to_world(instance.world, p) + Vec3(0.0));
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3)
      drawn.triangles.push_back({first + primitive.indices[i], first + primitive.indices[i + 1], first + primitive.indices[i + 2]});
    const bool double_sided = primitive.material >= 0 && scene.materials[primitive.material].double_sided;
    drawn.single_sided.resize(drawn.triangles.size(), !double_sided);
  });
  return drawn;
}

Provenance find_provenance(const Scene& scene, const Drawn& drawn, const Picture* picture) {
  Provenance provenance;
  provenance.source = source_attribute(scene);
  provenance.exact = !provenance.source.empty();
  if (provenance.source.empty() && picture != nullptr) {
    provenance.source.resize(drawn.position.size());
    parallel_each(drawn.position.size(), 1024, [&](std::size_t v) { provenance.source[v] = source_of(*picture, drawn.position[v]); });
  }
  if (picture != nullptr)
    provenance.branch = find_branches(drawn, *picture);
  else
    provenance.branch.assign(drawn.position.size(), 0);
  return provenance;
}

std::vector<std::uint32_t> first_equal(const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& tags, std::size_t& distinct) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  const auto key_of = [&](std::uint32_t i) { return key(positions[i], tags.empty() ? 0 : tags[i]); };
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(key_of(a), a) < std::tuple(key_of(b), b);
  });
  distinct = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_new = i == 0 || key_of(order[i]) != key_of(order[i - 1]);
    distinct += is_new;
    first[order[i]] = is_new ? order[i] : first[order[i - 1]];
  }
  return first;
}

std::vector<Corners> weld_triangles(const std::vector<Corners>& triangles, const std::vector<std::uint32_t>& first) {
  std::vector<Corners> welded;
  for (const Corners& t : triangles) {
    const Corners w{first[t[0]], first[t[1]], first[t[2]]};
    if (w[0] != w[1] && w[1] != w[2] && w[2] != w[0]) welded.push_back(w);
  }
  return welded;
}

EdgeUse use_edges(const std::vector<Corners>& triangles) {
  std::vector<Ends> edges;
  for (const Corners& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] != t[(k + 1) % 3]) edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  std::sort(edges.begin(), edges.end());
  EdgeUse use;
  for (auto it = edges.begin(); it != edges.end();) {
    const auto end = std::find_if(it, edges.end(), [&](const Ends& e) { return e != *it; });
    if (end - it == 1) use.open.push_back(*it);
    use.non_manifold += end - it > 2;
    it = end;
  }
  return use;
}

std::vector<std::uint32_t> ends_of(const std::vector<Ends>& edges) {
  std::vector<std::uint32_t> ids;
  for (const Ends& edge : edges) ids.insert(ids.end(), edge.begin(), edge.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

} // namespace domewarp
