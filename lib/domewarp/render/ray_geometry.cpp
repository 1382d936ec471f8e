// SPDX-License-Identifier: Apache-2.0
//
// Based on: Wald et al., Embree, 2014.
//
// Embree works in float32 and its choice among hits near an edge depends on the instruction set. Here it gets triangles
// that are slightly too large, so that it proposes every triangle the exact test could accept, and a filter function
// decides in double precision. The filter keeps the best hit itself and leaves Embree's ray a little longer than
// that, so that an equally near triangle is still proposed. Most proposals are hits beyond doubt (Gate): those are put
// off until Embree is done, when only the nearest few are left and their corners are on their way from memory.
#include "domewarp/render/ray_geometry.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <new>
#include <tuple>

#include <embree3/rtcore.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/render/ray_gate.h"
#include "domewarp/render/shading.h"
#include "domewarp/render/triangle.h"

namespace domewarp {

namespace {

/// Largest coordinate of the geometry given to Embree, so that products of three stay far from float32's limits.
constexpr int largest_exponent = 30;

struct DeviceDeleter {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceDeleter>;
using RayScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The nearness that ties are judged by: 2^-44 of the distance is coarser than the rounding of `intersect` for all but
/// grazing triangles, and finer than anything a picture shows.
double rounded_distance(double distance) {
  constexpr std::uint64_t dropped = (std::uint64_t{1} << 9) - 1; // of 53 bits
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(distance) + (dropped + 1) / 2) & ~dropped);
}

auto rank(const RayHit& hit) {
  return std::make_tuple(hit.order, hit.part->object, hit.part->first_triangle + hit.triangle);
}

} // namespace

struct RayGeometry::Impl {
  const Parts* parts = nullptr;
  std::vector<Facet> facets;         ///< by Embree primitive
  std::vector<Gate> gates;           ///< likewise
  std::vector<std::size_t> first_of; ///< by part: its first Embree primitive
  double scale = 1;                  ///< Embree's units per unit of eye space, a power of two
  Device device;
  RayScene scene;

  void number_triangles();
  void transform(const View& view);
  void commit(const std::string& embree);
  void attach_triangles();
  void fill(float* vertices, unsigned* indices) const;
  const Facet& facet(const RayHit& hit) const;
  void trace(std::span<const Ray> rays, RayHit* hits, bool* doubtful) const;
  template <unsigned width>
  static void judge_proposals(const RTCFilterFunctionNArguments* args);
  static void filter_hits(const RTCFilterFunctionNArguments* args);
  static void filter_blocks(const RTCFilterFunctionNArguments* args);
};

namespace {

/// What the filters need to know about the rays under way. Embree hands back a pointer to the first member; a ray's id
/// is its index.
struct RayQuery {
  RTCIntersectContext context;
  const void* geometry;
  const Ray* rays;
  RayHit* best;     ///< part null until something is found
  Waiting* waiting; ///< by ray; null: every proposal is judged at once
};

struct BlockQuery {
  RTCIntersectContext context;
  const void* geometry;
  Vec3 origin, direction;
  double near, far;
};

/// Texture and vertex alpha at a hit.
bool is_there(const RayHit& hit) {
  const Look& look = *hit.part->look;
  if (look.alpha_mode == AlphaMode::opaque) return true;
  const Vec2 uv = transform_uv(look.base, Vec2(interpolate(hit.part->base_uv, hit, Vec4(0))));
  return is_present(look, albedo_alpha(look, interpolate(hit.part->color, hit, Vec4(1)).a, uv));
}

} // namespace

void RayGeometry::Impl::number_triangles() {
  std::size_t count = 0;
  for (const Part& part : parts->parts) {
    first_of.push_back(count);
    count += part.primitive->indices.size() / 3;
  }
  if (count >= std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::input, "scene: " + std::to_string(count) + " triangles are more than can be ray-traced");
  facets.resize(count);
  gates.resize(count);
}

void RayGeometry::Impl::transform(const View& view) {
  std::vector<double> reach(parts->parts.size(), 0);
  parallel_each(parts->parts.size(), 1, [&](std::size_t i) {
    const Part& part = parts->parts[i];
    std::vector<Vec3> corners(part.primitive->positions.size());
    for (std::size_t k = 0; k < corners.size(); ++k) {
      corners[k] = to_eye(view, to_world(part.world, part.primitive->positions[k]));
      if (is_finite(corners[k])) reach[i] = std::max(reach[i], largest(corners[k]));
    }
    for (std::size_t k = 0; k < part.primitive->indices.size() / 3; ++k) {
      const std::uint32_t* index = &part.primitive->indices[3 * k];
      facets[first_of[i] + k] = {{corners[index[0]], corners[index[1]], corners[index[2]]},
                                 static_cast<std::uint32_t>(i),
                                 static_cast<std::uint32_t>(k)};
      gates[first_of[i] + k] = make_gate(facets[first_of[i] + k], *part.look);
    }
  });
  const double largest_reach = reach.empty() ? 0 : *std::max_element(reach.begin(), reach.end());
  if (largest_reach > 0) scale = std::ldexp(1.0, largest_exponent - std::ilogb(largest_reach));
}

const Facet& RayGeometry::Impl::facet(const RayHit& hit) const {
  return facets[first_of[std::size_t(hit.part - parts->parts.data())] + hit.triangle];
}

void RayGeometry::Impl::fill(float* vertices, unsigned* indices) const {
  parallel_each(facets.size(), 4096, [&](std::size_t i) {
    const auto& v = facets[i].corners;
    Vec3 inflated[3];
    const double farthest = std::max({largest(v[0]), largest(v[1]), largest(v[2])});
    inflate(v, inflation * farthest, inflated);
    for (std::size_t k = 0; k < 9; ++k) vertices[9 * i + k] = static_cast<float>(scale * inflated[k / 3][int(k % 3)]);
    for (std::size_t k = 0; k < 3; ++k) indices[3 * i + k] = static_cast<unsigned>(3 * i + k);
  });
}

RayGeometry::RayGeometry(const Parts& parts, const View& view, const std::string& embree)
    : impl_(std::make_unique<Impl>()) {
  impl_->parts = &parts;
  impl_->number_triangles();
  impl_->transform(view);
  impl_->commit(embree);
}

RayGeometry::~RayGeometry() = default;

const Vec3& RayGeometry::corner(const RayHit& hit, int i) const {
  return impl_->facet(hit).corners[i];
}

namespace {

/// A ray exactly through an edge meets the triangles on both sides of it. For what shines through that is one surface,
/// as it is for a rasteriser's fill rule.
bool is_same_crossing(const RayHit& a, const RayHit& b) {
  const auto on_edge = [](const RayHit& hit) {
    return hit.weights[0] == 0 || hit.weights[1] == 0 || hit.weights[2] == 0;
  };
  return a.part->object == b.part->object && on_edge(a) && on_edge(b) &&
         std::abs(a.distance - b.distance) <= 1e-12 * a.distance;
}

/// Judges one proposal of Embree's and keeps it when it is the best so far.
bool judge(const Ray& ray, RayHit& best, const Part& part, const Facet& facet) {
  Crossing crossing;
  if (!intersect(ray.direction, make_pyramid(facet.corners), crossing) || crossing.distance < ray.near) return false;
  if (!part.look->double_sided && crossing.det > 0) return false;
  RayHit hit{crossing.distance, rounded_distance(crossing.distance), &part, facet.triangle, {}};
  if (best.part && !(rank(hit) < rank(best))) return false;
  std::copy(crossing.weights, crossing.weights + 3, hit.weights);
  if (ray.previous && (!(rank(*ray.previous) < rank(hit)) || is_same_crossing(*ray.previous, hit))) return false;
  if (!is_there(hit)) return false;
  best = hit;
  return true;
}

bool blocks(const BlockQuery& query, const Part& part, const Facet& facet) {
  if (part.look->alpha_mode == AlphaMode::blend) return false;
  const auto& v = facet.corners;
  Crossing crossing;
  if (!intersect(query.direction, make_pyramid({v[0] - query.origin, v[1] - query.origin, v[2] - query.origin}), crossing))
    return false;
  if (crossing.distance < query.near || crossing.distance > query.far) return false;
  RayHit hit{crossing.distance, 0, &part, facet.triangle, {}};
  std::copy(crossing.weights, crossing.weights + 3, hit.weights);
  return is_there(hit);
}

} // namespace

namespace {

/// What Embree proposes: one triangle to the lanes of a packet that pass it. The width is known when it is compiled,
/// because this is called for every ray.
template <unsigned width>
struct Proposals {
  const int* valid;
  RTCRayN* ray;
  RTCHitN* hit;

  /// Calls visit(lane) for the lanes that take part, often one of 16.
  template <typename Visit>
  void for_each_lane(Visit&& visit) const {
    constexpr unsigned group = std::min(width, 4u);
    for (unsigned first = 0; first < width; first += group) {
      int any = 0;
      for (unsigned lane = first; lane < first + group; ++lane) any |= valid[lane];
      for (unsigned lane = first; any && lane < first + group; ++lane)
        if (valid[lane] == -1) visit(lane);
    }
  }

  /// Puts a proposal off if it is a hit beyond doubt; the ray is cut a little behind it. @return whether it was
  bool put_off(const RayQuery& query, unsigned lane, unsigned index, std::uint32_t primitive, const Gate& gate) const {
    if (!query.waiting || query.rays[index].previous) return false;
    const float u = RTCHitN_u(hit, width, lane), v = RTCHitN_v(hit, width, lane);
    if (!(std::min({u, v, 1 - u - v}) > gate.margin)) return false;
    const float distance = RTCRayN_tfar(ray, width, lane), slack = gate.slack;
    if (!(distance * (1 - slack) > RTCRayN_tnear(ray, width, lane) * 1.02f)) return false;
    if (!query.waiting[index].add(primitive, distance * (1 - slack), distance * (1 + slack))) return false;
    RTCRayN_tfar(ray, width, lane) = distance * (1 + slack) * (1 + slack);
    return true;
  }
};

} // namespace

template <unsigned width>
void RayGeometry::Impl::judge_proposals(const RTCFilterFunctionNArguments* args) {
  const RayQuery& query = *reinterpret_cast<RayQuery*>(args->context);
  const Impl& impl = *static_cast<const Impl*>(query.geometry);
  const Proposals<width> proposals{args->valid, args->ray, args->hit};
  proposals.for_each_lane([&](unsigned lane) {
    const std::uint32_t primitive = RTCHitN_primID(args->hit, width, lane);
    const Facet& facet = impl.facets[primitive];
    __builtin_prefetch(&facet);
    __builtin_prefetch(reinterpret_cast<const char*>(&facet + 1) - 1);
    const unsigned index = RTCRayN_id(args->ray, width, lane);
    const Gate gate = impl.gates[primitive];
    if (proposals.put_off(query, lane, index, primitive, gate)) return;
    if (judge(query.rays[index], query.best[index], impl.parts->parts[facet.part], facet))
      RTCRayN_tfar(args->ray, width, lane) =
          static_cast<float>(query.best[index].distance * impl.scale * (1 + double(gate.slack)));
    else
      args->valid[lane] = 0;
  });
}

void RayGeometry::Impl::filter_hits(const RTCFilterFunctionNArguments* args) {
  switch (args->N) {
    case 1: return judge_proposals<1>(args);
    case 4: return judge_proposals<4>(args);
    case 8: return judge_proposals<8>(args);
    case 16: return judge_proposals<16>(args);
  }
}

void RayGeometry::Impl::filter_blocks(const RTCFilterFunctionNArguments* args) {
  if (args->valid[0] != -1) return;
  const BlockQuery& query = *reinterpret_cast<BlockQuery*>(args->context);
  const Impl& impl = *static_cast<const Impl*>(query.geometry);
  const Facet& facet = impl.facets[RTCHitN_primID(args->hit, args->N, 0)];
  if (!blocks(query, impl.parts->parts[facet.part], facet)) args->valid[0] = 0;
}

void RayGeometry::Impl::attach_triangles() {
  const RTCGeometry mesh = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcAttachGeometry(scene.get(), mesh);
  rtcReleaseGeometry(mesh);
  void* vertices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * facets.size());
  void* indices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, facets.size());
  if (!vertices || !indices) throw std::bad_alloc();
  fill(static_cast<float*>(vertices), static_cast<unsigned*>(indices));
  rtcSetGeometryIntersectFilterFunction(mesh, filter_hits);
  rtcSetGeometryOccludedFilterFunction(mesh, filter_blocks);
  rtcCommitGeometry(mesh);
}

void RayGeometry::Impl::commit(const std::string& embree) {
  device.reset(rtcNewDevice(embree.empty() ? nullptr : embree.c_str()));
  if (!device && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (!device) throw Error(ErrorCode::output, "Embree: cannot be started");
  scene.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  if (!facets.empty()) attach_triangles();
  rtcCommitScene(scene.get());
  const RTCError error = rtcGetDeviceError(device.get());
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE)
    throw Error(ErrorCode::output,
                "Embree: cannot build its tree (error " + std::to_string(static_cast<int>(error)) + ")");
}

/// @param doubtful where a proposal was put off that turned out to be no hit, so that what lies behind may be missing;
///        null: none is put off
void RayGeometry::Impl::trace(std::span<const Ray> rays, RayHit* hits, bool* doubtful) const {
  RayQuery query{};
  Waiting waiting[packet_size];
  rtcInitIntersectContext(&query.context);
  query.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  query.geometry = this;
  query.rays = rays.data();
  query.best = hits;
  query.waiting = doubtful ? waiting : nullptr;
  alignas(64) RTCRayHit16 packet{};
  alignas(64) int valid[packet_size] = {};
  for (unsigned i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    hits[i].part = nullptr;
    valid[i] = -1;
    packet.ray.dir_x[i] = static_cast<float>(ray.direction.x);
    packet.ray.dir_y[i] = static_cast<float>(ray.direction.y);
    packet.ray.dir_z[i] = static_cast<float>(ray.direction.z);
    // One hundredth is the largest slack, so no hit that float32 puts too near is lost.
    const double nearest = std::max(ray.near, ray.previous ? ray.previous->distance : 0.0);
    packet.ray.tnear[i] = static_cast<float>(0.99 * scale * nearest);
    packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
    packet.ray.mask[i] = ~0u;
    packet.ray.id[i] = i;
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  }
  rtcIntersect16(valid, scene.get(), &query.context, &packet);
  for (std::size_t i = 0; doubtful && i < rays.size(); ++i)
    waiting[i].for_each([&](std::uint32_t primitive) {
      const Facet& facet = facets[primitive];
      RayHit other;
      RayHit& hit = hits[i].part ? other : hits[i];
      if (!judge(rays[i], hit, parts->parts[facet.part], facet))
        doubtful[i] = true;
      else if (rank(hit) < rank(hits[i]))
        hits[i] = hit;
    });
}

void RayGeometry::first_hits(std::span<const Ray> rays, RayHit* hits) const {
  bool doubtful[packet_size] = {};
  impl_->trace(rays, hits, doubtful);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (doubtful[i]) impl_->trace(rays.subspan(i, 1), hits + i, nullptr);
}

bool RayGeometry::is_blocked(const Vec3& origin, const Vec3& direction, double near, double far) const {
  BlockQuery query{};
  rtcInitIntersectContext(&query.context);
  query.geometry = impl_.get();
  query.origin = origin;
  query.direction = direction;
  query.near = near;
  query.far = far;
  RTCRay ray{};
  ray.org_x = static_cast<float>(impl_->scale * origin.x);
  ray.org_y = static_cast<float>(impl_->scale * origin.y);
  ray.org_z = static_cast<float>(impl_->scale * origin.z);
  ray.dir_x = static_cast<float>(direction.x);
  ray.dir_y = static_cast<float>(direction.y);
  ray.dir_z = static_cast<float>(direction.z);
  ray.tfar = std::numeric_limits<float>::infinity(); // the filter knows the ends in double precision
  ray.mask = ~0u;
  rtcOccluded1(impl_->scene.get(), &query.context, &ray);
  return ray.tfar < 0;
}

namespace {

struct PointLookup {
  const RayGeometry* geometry;
  std::vector<RayHit>* hits;
  Vec3 point;
  double tolerance;
};

} // namespace

void RayGeometry::triangles_at(const Vec3& point, double tolerance, std::vector<RayHit>& hits) const {
  hits.clear();
  RTCPointQuery query{};
  query.x = static_cast<float>(impl_->scale * point.x);
  query.y = static_cast<float>(impl_->scale * point.y);
  query.z = static_cast<float>(impl_->scale * point.z);
  // Rounded to float32, the point moves; the triangles grew by `inflation` of their coordinates, which covers it.
  query.radius = static_cast<float>(impl_->scale * (tolerance + 1e-6 * largest(point)));
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  PointLookup lookup{this, &hits, point, tolerance};
  const RTCPointQueryFunction visit = [](RTCPointQueryFunctionArguments* args) {
    PointLookup& wanted = *static_cast<PointLookup*>(args->userPtr);
    const Impl& impl = *wanted.geometry->impl_;
    const auto& [v, part, triangle] = impl.facets[args->primID];
    RayHit hit;
    hit.part = &impl.parts->parts[part];
    hit.triangle = triangle;
    const bool from_behind = glm::dot(glm::cross(v[1] - v[0], v[2] - v[0]), v[0]) > 0;
    if (from_behind && !hit.part->look->double_sided) return false;
    const auto weights = weights_near(v, wanted.point, wanted.tolerance);
    if (!weights) return false;
    std::copy(weights->begin(), weights->end(), hit.weights);
    wanted.hits->push_back(hit);
    return false;
  };
  rtcPointQuery(impl_->scene.get(), &query, &context, visit, &lookup);
}

std::optional<std::array<double, 3>> RayGeometry::weights_at(const RayHit& hit, const Vec3& point, double tolerance) const {
  return weights_near(impl_->facet(hit).corners, point, tolerance);
}

Vec4 interpolate(const Attribute* attribute, const RayHit& hit, const Vec4& fallback) {
  if (!attribute) return fallback;
  Vec4 value(0, 0, 0, attribute->components < 4 ? 1 : 0);
  for (int corner = 0; corner < 3; ++corner) {
    const std::uint32_t index = hit.part->primitive->indices[3 * std::size_t(hit.triangle) + std::size_t(corner)];
    const float* entry = &attribute->values[std::size_t(index) * std::size_t(attribute->components)];
    for (int i = 0; i < attribute->components; ++i) value[i] += hit.weights[corner] * double(entry[i]);
  }
  return value;
}

} // namespace domewarp
