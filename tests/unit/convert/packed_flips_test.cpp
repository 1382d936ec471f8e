// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/packed_flips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "domewarp/gltf/read.h"

namespace domewarp {
namespace {

constexpr Raster raster{4096, 4096};

/// Long thin strips of triangles, as a railing far away: each point of a strip is off its line by less than `thickness`. Two
/// primitives share the positions of every strip. What is drawn is where it came from.
/// A triangle far off widens the grid.
Scene railings(unsigned seed, double thickness, double depth_range, double far_off) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::array<Primitive, 2> sides;
  for (int strip = 0; strip < 40; ++strip) {
    const Vec2 from(1.8 * unit(random) - 0.9, 1.8 * unit(random) - 0.9), to(1.8 * unit(random) - 0.9, 1.8 * unit(random) - 0.9);
    const Vec2 across = thickness * Vec2(from.y - to.y, to.x - from.x) / glm::length(to - from);
    const double near = 1 + depth_range * unit(random), far = 1 + depth_range * unit(random);
    const auto at = [&](double t, double off) {
      const double w = near + t * (far - near);
      return Vec3f(Vec3(w * (from + t * (to - from) + off * across), -w));
    };
    std::array<std::vector<Vec3f>, 3> rail; // the middle one belongs to both sides
    for (int i = 0; i <= 20; ++i)
      for (int k = 0; k < 3; ++k) rail[k].push_back(at((i + 0.8 * unit(random) * (i > 0 && i < 20)) / 20.0, k - 1 + 0.2 * unit(random)));
    for (int k = 0; k < 2; ++k) {
      const auto first = static_cast<std::uint32_t>(sides[k].positions.size());
      for (const auto* r : {&rail[k], &rail[k + 1]}) sides[k].positions.insert(sides[k].positions.end(), r->begin(), r->end());
      for (std::uint32_t i = 0; i < 20; ++i)
        for (const std::uint32_t v : {i, i + 1, 21 + i, 21 + i, i + 1, 22 + i}) sides[k].indices.push_back(first + v);
    }
  }
  if (far_off > 0) {
    const auto first = static_cast<std::uint32_t>(sides[0].positions.size());
    for (const Vec3& p : {Vec3(-0.5, -0.5, -1), Vec3(0.5, -0.5, -1), Vec3(0, 0.5, -1)}) sides[0].positions.push_back(Vec3f(far_off * p));
    for (const std::uint32_t v : {0u, 1u, 2u}) sides[0].indices.push_back(first + v);
  }
  Scene scene;
  for (Primitive& side : sides) {
    Attribute source{"_SOURCE_POSITION", 3, {}};
    for (const Vec3f& p : side.positions) source.values.insert(source.values.end(), {p.x, p.y, p.z});
    side.attributes = {source};
    scene.meshes.push_back({"side", {side}});
    scene.instances.push_back({"side", static_cast<int>(scene.meshes.size()) - 1, Mat4(1)});
  }
  return scene;
}

Scene reread(const Scene& scene, const WriteOptions& options) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / ("packed_flips_" + std::to_string(::getpid()) + ".glb");
  write_scene(scene, path, options);
  Scene again = read_scene(path);
  std::filesystem::remove(path);
  return again;
}

Vec2 shown(const Vec3& p, Projection projection) { return projection == Projection::orthographic ? Vec2(p) : Vec2(p) / -p.z; }

double largest(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Whether the eye sees a triangle in single precision so nearly from its edge that nobody can say how it turns.
bool is_edge_on(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double size = std::max({largest(a), largest(b), largest(c)});
  return std::abs(glm::dot(a, glm::cross(b - a, c - a))) <= 0x1p-18 * size * size * (largest(b - a) + largest(c - a));
}

double twice_area(const std::array<Vec2, 3>& p) { return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x); }

using Source = std::tuple<float, float, float>;

/// Triangles of a decoded file that turn otherwise than their sources, by more than a thousandth of a pixel; and how many places
/// the vertices of one source position have, at most.
struct Seen {
  std::size_t turned = 0, places = 0, triangles = 0;
  std::map<Source, std::set<Source>> positions;
};

Seen look(const Scene& scene, Projection projection) {
  Seen seen;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives) {
      const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
      const auto from = [&](std::uint32_t v) { return Vec3(source[3 * v], source[3 * v + 1], source[3 * v + 2]); };
      const auto drawn = [&](std::uint32_t v) { return Vec3(instance.world * Vec4(Vec3(primitive.positions[v]), 1)); };
      for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        std::array<Vec2, 3> before, after;
        for (std::size_t k = 0; k < 3; ++k) {
          before[k] = shown(from(primitive.indices[i + k]), projection);
          after[k] = shown(drawn(primitive.indices[i + k]), projection);
        }
        const double longest = std::max({glm::length(after[1] - after[0]), glm::length(after[2] - after[1]), glm::length(after[0] - after[2])});
        const bool is_thick = std::abs(twice_area(after)) > 1e-3 * pixel_size(raster) * longest;
        const std::uint32_t* v = &primitive.indices[i];
        if (projection == Projection::perspective && is_edge_on(from(v[0]), from(v[1]), from(v[2]))) continue;
        seen.turned += is_thick && (twice_area(before) > 0) != (twice_area(after) > 0);
        ++seen.triangles;
      }
      for (std::uint32_t v = 0; v < primitive.positions.size(); ++v) {
        const Vec3 s = from(v), p = drawn(v);
        std::set<Source>& places = seen.positions[{static_cast<float>(s.x), static_cast<float>(s.y), static_cast<float>(s.z)}];
        places.insert({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
        seen.places = std::max(seen.places, places.size());
      }
    }
  return seen;
}

struct Form {
  WriteOptions write;
  double thickness; ///< image units: near a step of the grid
  double far_off;
};
const std::array<Form, 2> forms{Form{{.draco = true}, 5e-5, 120}, Form{{.quantize = true}, 4e-5, 0}};

TEST(PackedFlips, RoundingTurnsSliversOverAndMendingTurnsThemBack) {
  for (const Form& form : forms)
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
      for (const unsigned seed : {1u, 2u, 3u}) {
        if (form.write.draco && projection == Projection::orthographic) continue; // what turns there is too thin for single precision
        Scene scene = railings(seed, form.thickness, projection == Projection::perspective ? 1 : 0, projection == Projection::perspective ? form.far_off : 0);
        const Seen before = look(reread(scene, form.write), projection);
        EXPECT_GT(before.turned, 4u) << "these strips try nothing"; // the negative control
        WriteOptions write = form.write;
        const PackedFlips flips = mend_packed_flips(scene, write, projection, raster);
        EXPECT_GE(flips.found, before.turned);
        EXPECT_EQ(flips.left, 0u) << "seed " << seed << " draco " << form.write.draco;
        EXPECT_GT(flips.moved_px, 0);
        EXPECT_LT(flips.moved_px, 3.5 * 3 * grid_step(*write.grid) / pixel_size(raster)); // three steps and a half in all three directions, seen aslant
        const Seen after = look(reread(scene, write), projection);
        EXPECT_EQ(after.turned, 0u) << "seed " << seed << " draco " << form.write.draco;
        EXPECT_EQ(after.places, 1u) << "torn";
        EXPECT_EQ(after.positions.size(), before.positions.size());
      }
}

TEST(PackedFlips, TheOrderOfTrianglesDoesNotMatter) {
  for (const Form& form : forms) {
    Scene scene = railings(4, form.thickness, 1, form.far_off), turned = railings(4, form.thickness, 1, form.far_off);
    std::mt19937 random(5);
    for (Mesh& mesh : turned.meshes) {
      std::vector<std::uint32_t>& indices = mesh.primitives[0].indices;
      std::vector<std::array<std::uint32_t, 3>> triangles;
      for (std::size_t i = 0; i < indices.size(); i += 3) triangles.push_back({indices[i + 1], indices[i + 2], indices[i]});
      std::shuffle(triangles.begin(), triangles.end(), random);
      for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = triangles[i / 3][i % 3];
    }
    std::swap(turned.meshes[0], turned.meshes[1]);
    WriteOptions write = form.write;
    EXPECT_GT(mend_packed_flips(scene, write, Projection::perspective, raster).found, 0u);
    write = form.write;
    mend_packed_flips(turned, write, Projection::perspective, raster);
    EXPECT_EQ(look(reread(scene, write), Projection::perspective).positions, look(reread(turned, write), Projection::perspective).positions);
  }
}

TEST(PackedFlips, LeavesAloneWhatIsNotRounded) {
  Scene scene = railings(6, 1e-5, 1, 0);
  const Scene before = scene;
  WriteOptions write{.meshopt = true};
  EXPECT_EQ(mend_packed_flips(scene, write, Projection::perspective, raster).found, 0u);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) EXPECT_EQ(scene.meshes[m].primitives[0].positions, before.meshes[m].primitives[0].positions);
}

} // namespace
} // namespace domewarp
