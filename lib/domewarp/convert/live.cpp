// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/live.h"

#include <algorithm>
#include <array>
#include <string>

#include <glm/matrix.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/refine/warped_vertex.h"

namespace domewarp {

namespace {

// Points on their way from the mesh to the map: these stay in the first cache.
constexpr std::size_t block = 1024;

struct Block {
  alignas(64) std::array<float, block> x, y, z;
};

void append(LiveMesh& mesh, int instance, int primitive, std::size_t count, const Mat4& world) {
  mesh.parts.push_back({instance, primitive, mesh.positions.size(), count, world});
}

void append_source_positions(const Primitive& primitive, const std::string& where, LiveMesh& mesh) {
  const Attribute* source = find_attribute(primitive, source_position);
  if (!source)
    throw Error(ErrorCode::usage, "make_live_mesh: " + where + " has no " + source_position + ": convert with source attributes");
  for (std::size_t i = 0; i < primitive.positions.size(); ++i)
    mesh.positions.emplace_back(source->values[3 * i], source->values[3 * i + 1], source->values[3 * i + 2]);
}

// Points [begin, end) of one part into eye space, `at` places into the block. Written out by coordinate for the compiler to vectorise.
void to_eye_space(const Mat4& m, const Vec3f* points, std::size_t count, Block& out, std::size_t at) {
  for (std::size_t i = 0; i < count; ++i) {
    const double x = points[i].x, y = points[i].y, z = points[i].z;
    out.x[at + i] = static_cast<float>(m[0].x * x + m[1].x * y + m[2].x * z + m[3].x);
    out.y[at + i] = static_cast<float>(m[0].y * x + m[1].y * y + m[2].y * z + m[3].y);
    out.z[at + i] = static_cast<float>(m[0].z * x + m[1].z * y + m[2].z * z + m[3].z);
  }
}

std::size_t part_of(const LiveMesh& mesh, std::size_t vertex) {
  const auto after = std::ranges::upper_bound(mesh.parts, vertex, {}, &LivePart::first);
  return static_cast<std::size_t>(after - mesh.parts.begin()) - 1;
}

void rewarp_block(const LiveMesh& mesh, const Mat4& view, const BatchMap& map, BatchOutput output, std::span<Vec3f> out, std::size_t begin,
                  std::size_t end) {
  Block eye;
  std::size_t part = part_of(mesh, begin);
  for (std::size_t at = begin; at < end; ++part) {
    const LivePart& p = mesh.parts[part];
    const std::size_t stop = std::min(end, p.first + p.count);
    to_eye_space(view * p.world, mesh.positions.data() + at, stop - at, eye, at - begin);
    at = stop;
  }
  map.map({eye.x.data(), eye.y.data(), eye.z.data(), 1}, interleaved(&out[begin].x), end - begin, output);
}

} // namespace

LiveMesh make_live_mesh(const Scene& scene) {
  LiveMesh mesh;
  for (int i = 0; i < static_cast<int>(scene.instances.size()); ++i) {
    const Instance& instance = scene.instances[i];
    const auto& primitives = scene.meshes[instance.mesh].primitives;
    for (int p = 0; p < static_cast<int>(primitives.size()); ++p) {
      append(mesh, i, p, primitives[p].positions.size(), instance.world);
      mesh.positions.insert(mesh.positions.end(), primitives[p].positions.begin(), primitives[p].positions.end());
    }
  }
  return mesh;
}

LiveMesh make_live_mesh(const Scene& warped, const ConvertReport& report) {
  if (report.branches.size() > 1)
    throw Error(ErrorCode::usage, "make_live_mesh: the surface shows each point on up to " + std::to_string(report.branches.size()) +
                                      " branches, and which one a vertex belongs to is not known");
  const Mat4 world = glm::inverse(world_to_eye(report.view));
  LiveMesh mesh;
  for (int i = 0; i < static_cast<int>(warped.instances.size()); ++i) {
    const Instance& instance = warped.instances[i];
    const auto& primitives = warped.meshes[instance.mesh].primitives;
    for (int p = 0; p < static_cast<int>(primitives.size()); ++p) {
      append(mesh, i, p, primitives[p].positions.size(), world);
      append_source_positions(primitives[p], "primitive " + std::to_string(p) + " of " + instance.name, mesh);
    }
  }
  return mesh;
}

void rewarp(const LiveMesh& mesh, const View& view, const BatchMap& map, BatchOutput output, std::span<Vec3f> out) {
  if (out.size() != mesh.positions.size())
    throw Error(ErrorCode::usage, "rewarp: out must have room for " + std::to_string(mesh.positions.size()) + " points, got " +
                                      std::to_string(out.size()));
  const Mat4 to_eye = world_to_eye(view);
  const std::size_t count = out.size();
  parallel_each((count + block - 1) / block, 8, [&](std::size_t i) {
    rewarp_block(mesh, to_eye, map, output, out, i * block, std::min(count, (i + 1) * block));
  });
}

} // namespace domewarp
