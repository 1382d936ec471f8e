// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/ray_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include <embree3/rtcore.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/render/ray_geometry_impl.h"
#include "domewarp/render/triangle.h"

namespace domewarp {

namespace {

/// Largest coordinate of the geometry given to Embree, so that products of three stay far from float32's limits.
constexpr int largest_exponent = 30;

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

} // namespace

void DeviceDeleter::operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
void SceneDeleter::operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }

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
