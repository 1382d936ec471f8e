// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/drawn_crossings.h"

#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "domewarp/render/parts.h"
#include "domewarp/render/pieces.h"
#include "domewarp/render/ray_geometry.h"
#include "domewarp/render/shading.h"

namespace domewarp {

namespace {

/// Parts are ordered by object and first triangle.
const Part& part_of(const Parts& parts, const Crossing& crossing) {
  const auto after =
      std::upper_bound(parts.parts.begin(), parts.parts.end(), crossing, [](const Crossing& c, const Part& part) {
        return std::tie(c.object, c.triangle) < std::tie(part.object, part.first_triangle);
      });
  return *(after - 1);
}

bool is_drawn(const Parts& parts, const Crossing& crossing) {
  const Part& part = part_of(parts, crossing);
  const Look& look = *part.look;
  if (!crossing.front && !look.double_sided) return false;
  if (look.alpha_mode == AlphaMode::opaque) return true;
  RayHit hit;
  hit.part = &part;
  hit.triangle = crossing.triangle - part.first_triangle;
  std::copy(crossing.weights, crossing.weights + 3, hit.weights);
  const Vec2 uv = transform_uv(look.base, Vec2(interpolate(part.base_uv, hit, Vec4(0))));
  return is_present(look, albedo_alpha(look, interpolate(part.color, hit, Vec4(1)).a, uv));
}

} // namespace

CrossingsAlong keep_drawn(const Scene& scene, CrossingsAlong crossings, double near) {
  const auto parts = std::make_shared<const Parts>(prepare_parts(scene));
  const auto pieces = std::make_shared<const Pieces>(*parts);
  return [parts, pieces, crossings = std::move(crossings), near](const Vec3& direction) {
    std::vector<Crossing> all = crossings(direction);
    std::erase_if(all, [&](const Crossing& c) { return c.distance < near || !is_drawn(*parts, c); });
    for (Crossing& c : all) {
      const Part& part = part_of(*parts, c);
      c.piece = pieces->of(std::size_t(&part - parts->parts.data()), c.triangle - part.first_triangle);
    }
    return all;
  };
}

} // namespace domewarp
