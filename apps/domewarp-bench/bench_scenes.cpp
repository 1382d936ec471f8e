// SPDX-License-Identifier: Apache-2.0
#include "bench_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/scene/test_scenes.h"

namespace domewarp::bench {

Scene cave(std::size_t triangles) {
  const auto rows = static_cast<std::uint32_t>(std::max(3.0, std::round(std::sqrt(static_cast<double>(triangles) / 4))));
  const std::uint32_t columns = 2 * rows;
  Primitive primitive;
  Attribute normal{"NORMAL", 3, {}}, uv{"TEXCOORD_0", 2, {}};
  for (std::uint32_t i = 0; i <= rows; ++i)
    for (std::uint32_t j = 0; j <= columns; ++j) {
      const double v = static_cast<double>(i) / rows, u = static_cast<double>(j % columns) / columns;
      const double theta = std::numbers::pi * v, phi = 2 * std::numbers::pi * u;
      const Vec3 out(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      const double radius = 5 + 0.5 * std::sin(9 * theta) * std::sin(7 * phi) * std::sin(theta);
      primitive.positions.push_back(Vec3f(out * radius));
      for (int c = 0; c < 3; ++c) normal.values.push_back(static_cast<float>(-out[c]));
      uv.values.insert(uv.values.end(), {static_cast<float>(static_cast<double>(j) / columns), static_cast<float>(v)});
    }
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t a = i * (columns + 1) + j, b = a + 1, c = a + columns + 1, d = c + 1;
      primitive.indices.insert(primitive.indices.end(), {a, c, b, b, c, d});
    }
  primitive.attributes = {std::move(normal), std::move(uv)};
  primitive.material = 0;
  Scene scene;
  scene.meshes.push_back({"cave", {std::move(primitive)}});
  scene.instances.push_back({"cave", 0, Mat4(1)});
  scene.materials.emplace_back();
  return scene;
}

Scene bundled(const std::string& name) {
  for (TestScene& test : make_test_scenes())
    if (test.name == name) return std::move(test.scene);
  throw Error(ErrorCode::usage, "there is no bundled scene '" + name + "'");
}

Scene box() {
  const Vec3f low(-3.1F, -1.6F, -6.3F), high(2.7F, 1.9F, 2.2F);
  Primitive primitive;
  for (int i = 0; i < 8; ++i) primitive.positions.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  for (const std::array<std::uint32_t, 4>& quad : {std::array<std::uint32_t, 4>{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}})
    for (const std::size_t i : {0, 1, 2, 0, 2, 3}) primitive.indices.push_back(quad[i]);
  primitive.material = 0;
  Scene scene;
  scene.meshes.push_back({"box", {std::move(primitive)}});
  scene.instances.push_back({"box", 0, Mat4(1)});
  scene.materials.emplace_back();
  scene.materials[0].double_sided = true;
  return scene;
}

} // namespace domewarp::bench
