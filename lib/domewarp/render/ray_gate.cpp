// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/ray_gate.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "domewarp/render/triangle.h"

namespace domewarp {

Gate make_gate(const Facet& facet, const Look& look) {
  const auto& v = facet.corners;
  Gate gate{std::numeric_limits<float>::infinity(), static_cast<float>(distance_slack(v))};
  if (look.alpha_mode != AlphaMode::opaque || (!look.double_sided && make_pyramid(v).volume >= 0)) return gate;
  const double moved = inflation * std::max({largest(v[0]), largest(v[1]), largest(v[2])});
  const double side = std::max({glm::distance(v[0], v[1]), glm::distance(v[1], v[2]), glm::distance(v[2], v[0])});
  const double height = glm::length(glm::cross(v[1] - v[0], v[2] - v[0])) / side; // the least of three
  if (height > 0) gate.margin = static_cast<float>(1e-4 + 1.5 * moved / height);
  return gate;
}

} // namespace domewarp
