// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this folder: what ray_geometry.cpp builds and ray_search.cpp searches.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "domewarp/render/ray_gate.h"
#include "domewarp/render/ray_geometry.h"

struct RTCDeviceTy;
struct RTCSceneTy;
struct RTCFilterFunctionNArguments;

namespace domewarp {

struct DeviceDeleter {
  void operator()(RTCDeviceTy* device) const;
};
struct SceneDeleter {
  void operator()(RTCSceneTy* scene) const;
};

struct RayGeometry::Impl {
  const Parts* parts = nullptr;
  std::vector<Facet> facets;         ///< by Embree primitive
  std::vector<Gate> gates;           ///< likewise
  std::vector<std::size_t> first_of; ///< by part: its first Embree primitive
  double scale = 1;                  ///< Embree's units per unit of eye space, a power of two
  std::unique_ptr<RTCDeviceTy, DeviceDeleter> device; ///< outlives the scene
  std::unique_ptr<RTCSceneTy, SceneDeleter> scene;

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

} // namespace domewarp
