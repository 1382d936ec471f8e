// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/geometric_extensions.h"

#include <set>

#include <nlohmann/json.hpp>

namespace domewarp {

namespace {

/// Thickness and attenuation distance are lengths of the unwarped mesh; dispersion and scattering mean nothing without.
constexpr const char* geometric[] = {"KHR_materials_volume", "KHR_materials_volume_scatter", "KHR_materials_dispersion"};

} // namespace

std::vector<std::string> drop_geometric_extensions(Scene& scene) {
  std::set<std::string> dropped;
  for (Material& material : scene.materials) {
    if (material.json.find("KHR_materials_") == std::string::npos) continue;
    nlohmann::json object = nlohmann::json::parse(material.json);
    const auto extensions = object.find("extensions");
    if (extensions == object.end()) continue;
    for (const char* name : geometric)
      if (extensions->erase(name) > 0) dropped.insert(name);
    if (extensions->empty()) object.erase("extensions");
    material.json = object.dump();
  }
  return {dropped.begin(), dropped.end()};
}

} // namespace domewarp
