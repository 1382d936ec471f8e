// SPDX-License-Identifier: Apache-2.0
#include "render_scenes.h"

#include <algorithm>
#include <cstring>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>

namespace domewarp::test {

Display make_display(const std::string& curve, int width, int height) {
  SurfaceOptions options;
  options.curve = curve;
  const Raster raster{width, height};
  Surface surface(options, 1.3 * screen_radius(raster));
  ImageMap map = make_image_map(surface, Method::direct);
  return {raster, std::move(surface), std::move(map)};
}

Mesh make_quad(const Vec3& a, const Vec3& u, const Vec3& v, int material, double uv_scale) {
  Primitive quad;
  quad.material = material;
  const Vec2 uv[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  Attribute coordinates{"TEXCOORD_0", 2, {}};
  for (const Vec2& c : uv) {
    quad.positions.push_back(Vec3f(a + c.x * u + c.y * v));
    coordinates.values.push_back(static_cast<float>(uv_scale * c.x));
    coordinates.values.push_back(static_cast<float>(uv_scale * c.y));
  }
  quad.attributes.push_back(coordinates);
  quad.indices = {0, 1, 2, 0, 2, 3};
  return {"quad", {quad}};
}

void add(Scene& scene, Mesh mesh, const Mat4& world) {
  scene.instances.push_back({mesh.name, static_cast<int>(scene.meshes.size()), world});
  scene.meshes.push_back(std::move(mesh));
}

int add_material(Scene& scene, const Vec4& colour, AlphaMode mode, bool double_sided) {
  Material material;
  material.base_color = colour;
  material.alpha_mode = mode;
  material.double_sided = double_sided;
  scene.materials.push_back(material);
  return static_cast<int>(scene.materials.size()) - 1;
}

void add_texture(Scene& scene, int material, int wrap, int filter, int size) {
  std::mt19937 random(7);
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 3 * size * size; ++i) texels.push_back(static_cast<std::uint8_t>(random() % 256));
  Image image;
  image.bytes = encode_png(size, size, 3, texels);
  Sampler sampler;
  sampler.wrap_s = sampler.wrap_t = wrap;
  sampler.mag_filter = filter;
  Texture texture;
  texture.image = static_cast<int>(scene.images.size());
  texture.sampler = static_cast<int>(scene.samplers.size());
  scene.materials[std::size_t(material)].base_texture.texture = static_cast<int>(scene.textures.size());
  scene.images.push_back(image);
  scene.samplers.push_back(sampler);
  scene.textures.push_back(texture);
}

Scene make_room() {
  Scene scene;
  const Vec3 low(-2.1, -1.6, -3.2), size(4.5, 3.1, 4.9);
  const Vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  const Vec3 high = low + size;
  const struct {
    Vec3 corner, u, v;
    Vec4 colour;
  } walls[] = {{low, x, y, {0.8, 0.2, 0.2, 1}},    {low, z, x, {0.2, 0.8, 0.2, 1}},
               {low, y, z, {0.2, 0.2, 0.8, 1}},    {high, -y, -x, {0.8, 0.8, 0.2, 1}},
               {high, -x, -z, {0.2, 0.8, 0.8, 1}}, {high, -z, -y, {0.8, 0.2, 0.8, 1}}};
  for (const auto& wall : walls) add(scene, make_quad(wall.corner, wall.u, wall.v, add_material(scene, wall.colour)));
  return scene;
}

Scene make_room_with_board() {
  Scene scene = make_room();
  const int material = add_material(scene, {1, 0.5, 0.1, 1});
  add(scene, make_quad({-0.4, -0.5, -1.2}, {0.9, 0.1, 0.1}, {0, 0.8, 0}, material));
  return scene;
}

namespace {

struct Corner {
  Vec3 position;                  ///< eye space
  std::vector<double> attributes; ///< all of them, one after the other
};

Corner corner_at(const Primitive& primitive, const Mat4& world, std::uint32_t index) {
  Corner corner{to_eye(View{}, to_world(world, primitive.positions[index])), {}};
  for (const Attribute& attribute : primitive.attributes)
    for (int i = 0; i < attribute.components; ++i)
      corner.attributes.push_back(attribute.values[index * std::size_t(attribute.components) + std::size_t(i)]);
  return corner;
}

Corner blend(const Corner (&c)[3], double a, double b) {
  Corner corner{(1 - a - b) * c[0].position + a * c[1].position + b * c[2].position, {}};
  for (std::size_t i = 0; i < c[0].attributes.size(); ++i)
    corner.attributes.push_back((1 - a - b) * c[0].attributes[i] + a * c[1].attributes[i] + b * c[2].attributes[i]);
  return corner;
}

void emit(Primitive& target, const Corner& corner, const BranchMap& map, Output output, Camera& camera) {
  const Vec2 image = map.image(corner.position);
  const double rho = glm::length(corner.position), w = rho * map.factors(corner.position).g;
  const double depth = output == Output::perspective ? w : rho;
  const Vec3 position = output == Output::perspective ? w * Vec3(image, -1) : Vec3(image, -rho);
  target.positions.push_back(Vec3f(position));
  std::size_t next = 0;
  for (Attribute& attribute : target.attributes)
    for (int i = 0; i < attribute.components; ++i)
      attribute.values.push_back(attribute.name == "_SOURCE_POSITION" ? static_cast<float>(corner.position[i])
                                                                      : static_cast<float>(corner.attributes[next++]));
  target.indices.push_back(static_cast<std::uint32_t>(target.indices.size()));
  camera.znear = camera.znear > 0 ? std::min(camera.znear, depth) : depth;
  camera.zfar = std::max(camera.zfar, depth);
}

Primitive prewarp(const Primitive& primitive, const Mat4& world, const BranchMap& map, int divisions, Output output,
                  Camera& camera) {
  Primitive result;
  result.material = primitive.material;
  for (const Attribute& attribute : primitive.attributes)
    result.attributes.push_back({attribute.name, attribute.components, {}});
  result.attributes.push_back({"_SOURCE_POSITION", 3, {}});
  for (std::size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
    const Corner corners[3] = {corner_at(primitive, world, primitive.indices[t]),
                               corner_at(primitive, world, primitive.indices[t + 1]),
                               corner_at(primitive, world, primitive.indices[t + 2])};
    const auto put = [&](int i, int j) {
      emit(result, blend(corners, double(i) / divisions, double(j) / divisions), map, output, camera);
    };
    for (int j = 0; j < divisions; ++j)
      for (int i = 0; i + j < divisions; ++i) {
        put(i, j), put(i + 1, j), put(i, j + 1);
        if (i + j + 1 < divisions) put(i + 1, j), put(i + 1, j + 1), put(i, j + 1);
      }
  }
  return result;
}

} // namespace

Scene prewarp(const Scene& scene, const Display& display, int divisions, Output output) {
  Scene result = scene;
  Camera camera;
  camera.perspective = output == Output::perspective;
  camera.yfov = std::numbers::pi / 2;
  camera.aspect = camera.xmag = aspect(display.raster);
  camera.ymag = 1;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    Mesh mesh;
    for (const Primitive& primitive : scene.meshes[std::size_t(scene.instances[i].mesh)].primitives)
      mesh.primitives.push_back(
          prewarp(primitive, scene.instances[i].world, display.map.branches[0], divisions, output, camera));
    result.instances[i] = {scene.instances[i].name, static_cast<int>(result.meshes.size()), Mat4(1)};
    result.meshes.push_back(std::move(mesh));
  }
  result.cameras = {camera};
  return result;
}

std::size_t count_object_differences(const Frame& a, const Frame& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.object.size(); ++i) count += a.object[i] != b.object[i];
  return count;
}

bool is_same(const Frame& a, const Frame& b) {
  return a.rgba == b.rgba && a.object == b.object && a.triangle == b.triangle && a.depth.size() == b.depth.size() &&
         std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0 &&
         std::memcmp(a.position.data(), b.position.data(), a.position.size() * sizeof(Vec3f)) == 0;
}

bool is_outline(const Frame& frame, int column, int row) {
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, frame.height - 1); ++y)
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, frame.width - 1); ++x)
      if (frame.object[std::size_t(y * frame.width + x)] != frame.object[std::size_t(row * frame.width + column)])
        return true;
  return false;
}

} // namespace domewarp::test
