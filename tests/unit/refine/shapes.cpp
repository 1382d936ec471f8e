// SPDX-License-Identifier: Apache-2.0
#include "shapes.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace domewarp {

Scene triangles_scene(const std::vector<Vec3f>& corners) {
  Scene scene;
  Primitive primitive;
  primitive.material = 0;
  primitive.positions = corners;
  for (std::uint32_t i = 0; i < corners.size(); ++i) primitive.indices.push_back(i);
  scene.meshes.push_back({"shape", {primitive}});
  scene.instances.push_back({"shape", 0, Mat4(1)});
  scene.materials.emplace_back();
  scene.materials[0].double_sided = true;
  return scene;
}

Scene box_scene(const Vec3f& low, const Vec3f& high) {
  const auto corner = [&](int i) { return Vec3f(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z); };
  std::vector<Vec3f> corners;
  for (const auto& quad : {std::array{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}})
    for (const int i : {0, 1, 2, 0, 2, 3}) corners.push_back(corner(quad[static_cast<std::size_t>(i)]));
  return triangles_scene(corners);
}

SurfaceOptions curve(const std::string& expression) {
  SurfaceOptions options;
  options.curve = expression;
  return options;
}

SurfaceOptions lens(Lens kind, double fov_deg) {
  SurfaceOptions options;
  options.lens = kind;
  options.fov_deg = fov_deg;
  return options;
}

Conversion convert_shape(const Scene& scene, const SurfaceOptions& options, RefineOptions refine_options, Raster raster) {
  refine_options.source_attributes = true;
  refine_options.max_triangles = std::min<std::size_t>(refine_options.max_triangles, 200'000);
  const Surface surface(options, screen_radius(raster));
  const ImageMap map = make_image_map(surface, Method::automatic);
  Conversion conversion;
  conversion.scene = refine(scene, View{}, surface, map, raster, refine_options, conversion.report);
  return conversion;
}

namespace {

template <typename Visit>
void for_each_triangle(const Scene& warped, Visit&& visit) {
  for (const Mesh& mesh : warped.meshes)
    for (const Primitive& primitive : mesh.primitives) {
      const std::vector<float>& source = find_attribute(primitive, "_SOURCE_POSITION")->values;
      for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        std::array<Vec3, 3> position, eye;
        for (int k = 0; k < 3; ++k) {
          const std::size_t v = primitive.indices[i + static_cast<std::size_t>(k)];
          position[k] = Vec3(primitive.positions[v]);
          eye[k] = Vec3(source[3 * v], source[3 * v + 1], source[3 * v + 2]);
        }
        visit(position, eye);
      }
    }
}

} // namespace

double measured_error_px(const Conversion& conversion, const SurfaceOptions& options, Projection projection, const Raster& raster, int n) {
  const Surface surface(options, screen_radius(raster));
  const ImageMap map = make_image_map(surface, Method::direct);
  double worst = 0;
  for_each_triangle(conversion.scene, [&](const auto& position, const auto& eye) {
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 l = Vec3(i, j, n - i - j) / static_cast<double>(n);
        const Vec3 drawn = position[0] * l.x + position[1] * l.y + position[2] * l.z;
        const Vec3 source = eye[0] * l.x + eye[1] * l.y + eye[2] * l.z;
        const Vec2 image = projection == Projection::perspective ? Vec2(drawn) / -drawn.z : Vec2(drawn);
        worst = std::max(worst, glm::length(image - map.branches[0].image(source)) / pixel_size(raster));
      }
  });
  return worst;
}

double covered_solid_angle(const Scene& warped) {
  double sum = 0;
  for_each_triangle(warped, [&](const auto&, const auto& eye) {
    const Vec3 a = glm::normalize(eye[0]), b = glm::normalize(eye[1]), c = glm::normalize(eye[2]);
    const double volume = glm::dot(a, glm::cross(b, c));
    sum += 2 * std::atan2(std::abs(volume), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a)); // Van Oosterom and Strackee
  });
  return sum;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const SurfaceOptions& surface : {curve("1-r^2"), curve("3-sqrt(4+6*r^2)"), curve("1-r"), curve("-r^3+r^2+r+1"), curve("sqrt(1-r^2)"),
                                          lens(Lens::equidistant, 180), lens(Lens::equidistant, 240), lens(Lens::stereographic, 200)})
      all.push_back({surface, projection});
  return all;
}

} // namespace domewarp
