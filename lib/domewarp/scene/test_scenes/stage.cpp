// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/test_scenes/stage.h"

#include <cmath>
#include <utility>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "domewarp/scene/image.h"

namespace domewarp::test_scenes {

namespace {

using Json = nlohmann::ordered_json;

/// Close to the sRGB curve, which needs a power: exact at black and white, within 0.004 between.
double linear(double s) {
  return s * (s * (s * 0.305306011 + 0.682171111) + 0.012522878);
}

/// Four decimals: what a hand-written material would have.
double rounded(double x) {
  return std::floor(x * 10000 + 0.5) / 10000;
}

Json reference_json(const TextureReference& reference) {
  return {{"index", reference.texture}};
}

Json factor_json(const Vec4& v) {
  return {v.x, v.y, v.z, v.w};
}

Json surface_json(const Material& material) {
  Json json;
  json["baseColorFactor"] = factor_json(material.base_color);
  if (material.base_texture.texture >= 0) json["baseColorTexture"] = reference_json(material.base_texture);
  json["metallicFactor"] = material.metallic;
  json["roughnessFactor"] = material.roughness;
  return json;
}

std::string material_json(const Material& material) {
  Json json;
  json["name"] = material.name;
  json["pbrMetallicRoughness"] = surface_json(material);
  if (material.emissive != Vec3(0))
    json["emissiveFactor"] = {material.emissive.x, material.emissive.y, material.emissive.z};
  if (material.alpha_mode == AlphaMode::mask) {
    json["alphaMode"] = "MASK";
    json["alphaCutoff"] = material.alpha_cutoff;
  }
  if (material.double_sided) json["doubleSided"] = true;
  if (material.unlit) json["extensions"]["KHR_materials_unlit"] = Json::object();
  return json.dump();
}

/// A frame at `eye` whose -z axis points at `target`, y up unless that is straight above or below.
Mat4 looking(const Vec3& eye, const Vec3& target) {
  const Vec3 back = glm::normalize(eye - target);
  const Vec3 up = std::abs(back.y) > 0.999 ? Vec3(0, 0, -1) : Vec3(0, 1, 0);
  const Vec3 right = glm::normalize(glm::cross(up, back));
  return {Vec4(right, 0), Vec4(glm::cross(back, right), 0), Vec4(back, 0), Vec4(eye, 1)};
}

Material textured(Scene& scene, const std::string& name, const Picture& picture, double roughness, double metallic) {
  Material material;
  material.name = name;
  material.base_texture.texture = add_texture(scene, name, picture);
  material.roughness = roughness;
  material.metallic = metallic;
  return material;
}

} // namespace

Vec3 linear(std::uint32_t hex) {
  const Vec4 c = rgb(hex);
  return {rounded(linear(c.x)), rounded(linear(c.y)), rounded(linear(c.z))};
}

int add_texture(Scene& scene, const std::string& name, const Picture& picture) {
  if (scene.samplers.empty()) scene.samplers.push_back({10497, 10497, 9729, 9987});
  scene.images.push_back(
      {name, "image/png", "", encode_png(picture.width, picture.height, picture.channels, picture.samples)});
  scene.textures.push_back({static_cast<int>(scene.images.size()) - 1, 0, ""});
  return static_cast<int>(scene.textures.size()) - 1;
}

int add_material(Scene& scene, Material material) {
  material.json = material_json(material);
  scene.materials.push_back(std::move(material));
  return static_cast<int>(scene.materials.size()) - 1;
}

int add_plain(Scene& scene, const std::string& name, std::uint32_t color, double roughness, double metallic) {
  Material material;
  material.name = name;
  material.base_color = Vec4(linear(color), 1);
  material.roughness = roughness;
  material.metallic = metallic;
  return add_material(scene, std::move(material));
}

int add_textured(Scene& scene, const std::string& name, const Picture& picture, double roughness, double metallic) {
  return add_material(scene, textured(scene, name, picture, roughness, metallic));
}

int add_unlit(Scene& scene, const std::string& name, const Picture& picture) {
  Material material = textured(scene, name, picture, 1, 0);
  material.unlit = true;
  return add_material(scene, std::move(material));
}

int add_cutout(Scene& scene, const std::string& name, const Picture& picture, double roughness) {
  Material material = textured(scene, name, picture, roughness, 0);
  material.alpha_mode = AlphaMode::mask;
  material.double_sided = true;
  return add_material(scene, std::move(material));
}

int add_glowing(Scene& scene, const std::string& name, std::uint32_t color) {
  Material material;
  material.name = name;
  material.base_color = Vec4(0, 0, 0, 1);
  material.emissive = linear(color);
  material.metallic = 0;
  return add_material(scene, std::move(material));
}

int add_mesh(Scene& scene, const std::string& name, Shape shape, const ColorAt& color) {
  const auto is_plain = [&](int material) {
    return scene.materials[static_cast<std::size_t>(material)].base_texture.texture < 0;
  };
  for (Face& face : shape)
    if (is_plain(face.material)) face.uvs = {Vec2(0), Vec2(0), Vec2(0)};
  Mesh mesh = make_mesh(name, shape, color);
  for (Primitive& primitive : mesh.primitives)
    if (is_plain(primitive.material))
      std::erase_if(primitive.attributes, [](const Attribute& a) { return a.name == "TEXCOORD_0"; });
  scene.meshes.push_back(std::move(mesh));
  return static_cast<int>(scene.meshes.size()) - 1;
}

void add_instance(Scene& scene, const std::string& name, int mesh, const Mat4& world) {
  scene.instances.push_back({name, mesh, world});
}

void add_object(Scene& scene, const std::string& name, const Shape& shape, const Mat4& world, const ColorAt& color) {
  add_instance(scene, name, add_mesh(scene, name, shape, color), world);
}

void add_camera(Scene& scene, const std::string& name, const Vec3& eye, const Vec3& target, double yfov_degrees) {
  Camera camera;
  camera.name = name;
  camera.world = looking(eye, target);
  camera.yfov = yfov_degrees * pi / 180;
  camera.znear = 0.05;
  camera.zfar = 200;
  scene.cameras.push_back(camera);
}

void add_point_light(Scene& scene, const std::string& name, const Vec3& position, std::uint32_t color, double candela) {
  Light light;
  light.name = name;
  light.world = shift(position.x, position.y, position.z);
  light.color = linear(color);
  light.intensity = candela;
  scene.lights.push_back(light);
}

void add_sun(Scene& scene, const std::string& name, const Vec3& from, std::uint32_t color, double lux) {
  add_point_light(scene, name, from, color, lux);
  scene.lights.back().kind = LightKind::directional;
  scene.lights.back().world = looking(from, Vec3(0));
}

void add_spot(Scene& scene, const std::string& name, const Vec3& position, const Vec3& target, std::uint32_t color,
              double candela) {
  add_point_light(scene, name, position, color, candela);
  scene.lights.back().kind = LightKind::spot;
  scene.lights.back().world = looking(position, target);
  scene.lights.back().inner_cone = 0.5;
  scene.lights.back().outer_cone = 1;
}

} // namespace domewarp::test_scenes
