// SPDX-License-Identifier: Apache-2.0
//
// Based on: Wald et al., Embree, 2014.
//
// Embree works in float32 and its choice among hits near an edge depends on the instruction set. Here it has triangles
// that are slightly too large, so that it proposes every triangle the exact test could accept, and a filter function
// decides in double precision. The filter keeps the best hit itself and leaves Embree's ray a little longer than
// that, so that an equally near triangle is still proposed. Most proposals are hits beyond doubt (Gate): those are put
// off until Embree is done, when only the nearest few are left and their corners are on their way from memory.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include <embree3/rtcore.h>

#include "domewarp/render/ray_geometry_impl.h"
#include "domewarp/render/shading.h"
#include "domewarp/render/triangle.h"

namespace domewarp {

namespace {

/// The nearness that ties are judged by: 2^-44 of the distance is coarser than the rounding of `intersect` for all but
/// grazing triangles, and finer than anything a picture shows.
double rounded_distance(double distance) {
  constexpr std::uint64_t dropped = (std::uint64_t{1} << 9) - 1; // of 53 bits
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(distance) + (dropped + 1) / 2) & ~dropped);
}

auto rank(const RayHit& hit) {
  return std::make_tuple(hit.order, hit.part->object, hit.part->first_triangle + hit.triangle);
}

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

} // namespace domewarp
