// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/gl_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/render/shading.h"
#include "domewarp/scene/view.h"

namespace domewarp {

namespace {

void store(float* target, const Vec3& v) {
  for (int i = 0; i < 3; ++i) target[i] = static_cast<float>(v[i]);
}

Vec3 vec3_at(const Attribute& attribute, std::size_t vertex) {
  const float* v = &attribute.values[3 * vertex];
  return {v[0], v[1], v[2]};
}

Vec2 uv_at(const Attribute* attribute, const TextureUse& use, std::size_t vertex) {
  if (!attribute) return transform_uv(use, Vec2(0));
  return transform_uv(use, {attribute->values[2 * vertex], attribute->values[2 * vertex + 1]});
}

Vec4 colour_at(const Part& part, std::size_t vertex) {
  Vec4 colour(1);
  if (part.color) {
    const std::size_t components = std::size_t(part.color->components);
    for (std::size_t i = 0; i < components; ++i) colour[int(i)] = part.color->values[components * vertex + i];
  }
  return colour * part.look->base_color;
}

/// A normal beside a source position is in eye space already; any other goes with its object.
Vec3 normal_at(const Part& part, const Mat3& cofactor, std::size_t vertex) {
  if (!part.normal) return Vec3(0);
  const Vec3 n = vec3_at(*part.normal, vertex);
  return part.source ? n : cofactor * n;
}

GlVertex make_vertex(const Part& part, const Mat4& camera_from_world, const Mat3& cofactor, std::size_t i) {
  GlVertex vertex{};
  const Vec3 position(camera_from_world * Vec4(to_world(part.world, part.primitive->positions[i]), 1));
  store(vertex.position, position);
  store(vertex.source, part.source ? vec3_at(*part.source, i) : position);
  vertex.source[3] = part.source ? 1 : 0;
  store(vertex.normal, normal_at(part, cofactor, i));
  const Vec4 colour = colour_at(part, i);
  for (int k = 0; k < 4; ++k) vertex.colour[k] = static_cast<float>(colour[k]);
  const Vec2 base = uv_at(part.base_uv, part.look->base, i), glow = uv_at(part.glow_uv, part.look->glow, i);
  const double uv[4] = {base.x, base.y, glow.x, glow.y};
  for (int k = 0; k < 4; ++k) vertex.uv[k] = static_cast<float>(uv[k]);
  return vertex;
}

/// Appends the part's vertices; returns the number of its first one.
std::size_t append_vertices(GlGeometry& geometry, const Part& part, const Mat4& camera_from_world) {
  const std::size_t base = geometry.vertices.size(), count = part.primitive->positions.size();
  if (base + count > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::input, "scene: more than 2^32 vertices cannot be rasterised");
  const Mat3 m(camera_from_world * part.world);
  const Mat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  geometry.vertices.resize(base + count);
  parallel_each(count, 4096, [&](std::size_t i) {
    geometry.vertices[base + i] = make_vertex(part, camera_from_world, cofactor, i);
  });
  return base;
}

bool is_finite(const GlVertex& v) {
  return std::isfinite(v.position[0]) && std::isfinite(v.position[1]) && std::isfinite(v.position[2]);
}

double distance(const GlVertex& v) {
  return glm::length(Vec3(v.source[0], v.source[1], v.source[2]));
}

/// Extends the last batch or starts a new one.
void extend(std::vector<GlBatch>& batches, const Look* look, std::size_t triangle) {
  if (batches.empty() || batches.back().look != look) batches.push_back({look, triangle, 0});
  ++batches.back().count;
}

struct BlendedTriangle {
  double distance;
  const Look* look;
  GlTriangle triangle;
  GlIds ids;
};

void append_blended(GlGeometry& geometry, std::vector<BlendedTriangle>& list) {
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.distance > b.distance; });
  for (const BlendedTriangle& entry : list) {
    extend(geometry.blended, entry.look, geometry.triangles.size());
    geometry.triangles.push_back(entry.triangle);
    geometry.ids.push_back(entry.ids);
  }
}

void append_triangles(GlGeometry& geometry, const Part& part, std::size_t base, std::vector<BlendedTriangle>& blended) {
  const std::vector<std::uint32_t>& indices = part.primitive->indices;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    GlTriangle triangle;
    double sum = 0;
    bool finite = true;
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corners[k] = static_cast<std::uint32_t>(base + indices[i + k]);
      finite = finite && is_finite(geometry.vertices[triangle.corners[k]]);
      sum += distance(geometry.vertices[triangle.corners[k]]);
    }
    if (!finite) continue;
    const GlIds ids{part.object, static_cast<std::uint32_t>(part.first_triangle + i / 3 + 1)};
    if (part.look->alpha_mode == AlphaMode::blend) {
      blended.push_back({std::isfinite(sum) ? sum : 0, part.look, triangle, ids});
      continue;
    }
    extend(geometry.opaque, part.look, geometry.triangles.size());
    geometry.triangles.push_back(triangle);
    geometry.ids.push_back(ids);
  }
}

void append_strokes(GlGeometry& geometry, const Part& part, std::size_t base) {
  const std::size_t corners = part.primitive->topology == Topology::lines ? 2 : 1, first = geometry.strokes.size();
  const std::vector<std::uint32_t>& indices = part.primitive->indices;
  for (std::size_t i = 0; i + corners <= indices.size(); i += corners) {
    bool finite = true;
    for (std::size_t k = 0; k < corners; ++k) finite = finite && is_finite(geometry.vertices[base + indices[i + k]]);
    for (std::size_t k = 0; finite && k < corners; ++k)
      geometry.strokes.push_back(static_cast<std::uint32_t>(base + indices[i + k]));
  }
  geometry.stroke_batches.push_back({part.look, part.primitive->topology, first, geometry.strokes.size() - first});
}

} // namespace

GlGeometry make_gl_geometry(const Parts& parts, const Mat4& camera_from_world) {
  GlGeometry geometry;
  std::vector<BlendedTriangle> blended;
  for (const Part& part : parts.parts) {
    const std::size_t base = append_vertices(geometry, part, camera_from_world);
    append_triangles(geometry, part, base, blended);
  }
  append_blended(geometry, blended);
  for (const Part& part : parts.strokes) append_strokes(geometry, part, append_vertices(geometry, part, camera_from_world));
  return geometry;
}

} // namespace domewarp
