// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <string>

#include <embree3/rtcore.h>

#include "benches.h"
#include "domewarp/render/parts.h"
#include "domewarp/render/ray_geometry.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/scene/raster.h"
#include "domewarp/transform/image_map.h"
#include "render_growth.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

constexpr std::size_t packet_size = RayGeometry::packet_size;

/// A rough ball around the eye, 2 n^2 triangles.
Primitive make_rough_ball(std::uint32_t n) {
  Primitive ball;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t k = 0; k <= n; ++k) {
      const double a = std::numbers::pi * i / n, b = 2 * std::numbers::pi * k / n;
      const double r = 3 + 0.4 * std::sin(17 * a) * std::cos(23 * b) + 0.05 * std::sin(311 * a + 97 * b);
      ball.positions.push_back(Vec3f(r * std::sin(a) * std::cos(b), r * std::sin(a) * std::sin(b), r * std::cos(a)));
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = i * (n + 1) + k, c = a + n + 1;
      ball.indices.insert(ball.indices.end(), {a, a + 1, c, a + 1, c + 1, c});
    }
  ball.material = 0;
  return ball;
}

Scene make_scene(std::uint32_t n) {
  Scene scene;
  Material material;
  material.double_sided = true;
  scene.materials.push_back(material);
  scene.meshes.push_back({"ball", {make_rough_ball(n)}});
  scene.instances.push_back({"ball", 0, Mat4(1)});
  return scene;
}

/// Directions through all pixel centres, in squares of 4 x 4 within tiles, as the renderer goes.
std::vector<Vec3> make_directions(const Surface& surface, const Raster& raster) {
  std::vector<Vec3> directions;
  for (int top = 0; top < raster.height; top += 32)
    for (int left = 0; left < raster.width; left += 32)
      for (int i = 0; i < 32 * 32; ++i) {
        const int square = i / 16, column = 4 * (square % 8) + i % 4, row = 4 * (square / 8) + i % 16 / 4;
        if (Vec3 d; unproject(surface, pixel_centre(raster, left + column, top + row), d)) directions.push_back(d);
      }
  directions.resize(directions.size() / packet_size * packet_size);
  return directions;
}

/// Embree as its manual uses it, on the same triangles.
class PlainEmbree {
 public:
  PlainEmbree(const Primitive& mesh, const std::string& config)
      : device_(rtcNewDevice(config.c_str())), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t vertices = mesh.positions.size(), triangles = mesh.indices.size() / 3;
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, vertices),
                mesh.positions.data(), 12 * vertices);
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles),
                mesh.indices.data(), 12 * triangles);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~PlainEmbree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  PlainEmbree(const PlainEmbree&) = delete;
  PlainEmbree& operator=(const PlainEmbree&) = delete;

  std::size_t one_by_one(std::span<const Vec3> directions) const {
    std::size_t hits = 0;
    for (const Vec3& d : directions) {
      RTCIntersectContext context = make_context();
      RTCRayHit ray{};
      ray.ray.dir_x = float(d.x), ray.ray.dir_y = float(d.y), ray.ray.dir_z = float(d.z);
      ray.ray.tfar = INFINITY;
      ray.ray.mask = ~0u;
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene_, &context, &ray);
      hits += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
  }

  std::size_t in_packets(std::span<const Vec3> directions) const {
    std::size_t hits = 0;
    alignas(64) int valid[packet_size];
    std::fill(valid, valid + packet_size, -1);
    for (std::size_t first = 0; first < directions.size(); first += packet_size) {
      RTCIntersectContext context = make_context();
      alignas(64) RTCRayHit16 rays{};
      for (std::size_t i = 0; i < packet_size; ++i) {
        const Vec3& d = directions[first + i];
        rays.ray.dir_x[i] = float(d.x), rays.ray.dir_y[i] = float(d.y), rays.ray.dir_z[i] = float(d.z);
        rays.ray.tfar[i] = INFINITY;
        rays.ray.mask[i] = ~0u;
        rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect16(valid, scene_, &context, &rays);
      for (const unsigned geometry : rays.hit.geomID) hits += geometry != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;

  static RTCIntersectContext make_context() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
  }
};

std::size_t trace_ours(const RayGeometry& geometry, std::span<const Vec3> directions) {
  std::size_t hits = 0;
  Ray rays[packet_size];
  RayHit found[packet_size];
  for (std::size_t first = 0; first < directions.size(); first += packet_size) {
    for (std::size_t i = 0; i < packet_size; ++i) rays[i].direction = directions[first + i];
    geometry.first_hits(rays, found);
    for (const RayHit& hit : found) hits += hit.part != nullptr;
  }
  return hits;
}

using Tracer = std::function<std::size_t(std::span<const Vec3>)>;

struct Speed {
  double seconds = 0;
  std::size_t missed = 0; ///< rays
};

/// Every tracer takes all rays in turn, in pieces; each piece counts with its least time, so that a busy machine matters little.
std::vector<Speed> race(const std::vector<Tracer>& tracers, std::span<const Vec3> directions, int rounds) {
  constexpr std::size_t piece = 1 << 15;
  const std::size_t pieces = (directions.size() + piece - 1) / piece;
  std::vector<std::vector<double>> least(tracers.size(), std::vector<double>(pieces, std::numeric_limits<double>::infinity()));
  std::vector<Speed> speeds(tracers.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t t = 0; t < tracers.size(); ++t) {
      std::size_t hits = 0;
      for (std::size_t k = 0; k < pieces; ++k) {
        const auto part = directions.subspan(k * piece, std::min(piece, directions.size() - k * piece));
        least[t][k] = std::min(least[t][k], seconds([&] { hits += tracers[t](part); }));
      }
      speeds[t].missed = directions.size() - hits;
    }
  for (std::size_t t = 0; t < tracers.size(); ++t) speeds[t].seconds = std::accumulate(least[t].begin(), least[t].end(), 0.0);
  return speeds;
}

/// The instruction sets that rays are traced with here; Embree's own choice comes first.
std::vector<std::string> instruction_sets() {
  std::vector<std::string> sets = {"best"};
  if (__builtin_cpu_supports("avx512vl")) sets.push_back("avx2");
  if (__builtin_cpu_supports("avx2")) sets.push_back("sse4.2");
  return sets;
}

} // namespace

Result run_render_bench(const Options& options) {
  Result result;
  measure_pixels(options, result); // starts processes, so before any thread runs
  const Scene scene = make_scene(options.quick ? 20 : 707);
  const Raster raster = options.quick ? Raster{64, 64} : Raster{1024, 1024};
  SurfaceOptions display;
  display.curve = "1-r^2";
  const Surface surface(display, screen_radius(raster));
  const std::vector<Vec3> directions = make_directions(surface, raster);
  const Parts parts = prepare_parts(scene);
  Table table{"rays",
              std::to_string(directions.size()) + " primary rays of a dome, " + std::to_string(count_triangles(scene)) +
                  " triangles, one thread",
              {{"isa", "instructions"}, {"tracer", "tracer"}, {"ns_per_ray", "ns/ray"}, {"rate_ratio", "domewarp's rate / its"}, {"missed", "missed"}},
              {}};
  for (const std::string& set : instruction_sets()) {
    options.progress("primary rays, " + set);
    const std::string config = "threads=1" + (set == "best" ? "" : ",isa=" + set);
    const RayGeometry geometry(parts, View{}, config);
    const PlainEmbree embree(scene.meshes[0].primitives[0], config);
    const std::vector<Speed> speeds = race({[&](auto rays) { return embree.one_by_one(rays); },
                                            [&](auto rays) { return embree.in_packets(rays); },
                                            [&](auto rays) { return trace_ours(geometry, rays); }},
                                           directions, options.quick ? 1 : 9);
    const char* const names[] = {"Embree, rtcIntersect1", "Embree, rtcIntersect16", "domewarp, exact and tie-free"};
    for (std::size_t i = 0; i < 3; ++i)
      table.rows.push_back({set, names[i], 1e9 * speeds[i].seconds / double(directions.size()),
                            speeds[i].seconds / speeds[2].seconds, double(speeds[i].missed)});
  }
  result.tables.push_back(std::move(table));
  return result;
}

} // namespace domewarp::bench
