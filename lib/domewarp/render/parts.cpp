// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/parts.h"

#include <algorithm>
#include <cmath>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

template <typename T>
const T& entry(const std::vector<T>& list, int index, const char* kind) {
  if (index < 0 || std::size_t(index) >= list.size())
    throw Error(ErrorCode::input, std::string("scene: ") + kind + " " + std::to_string(index) + " does not exist");
  return list[std::size_t(index)];
}

Wrap wrap_of(int number) {
  return number == 33071 ? Wrap::clamp : number == 33648 ? Wrap::mirror : Wrap::repeat;
}

/// Offset * rotation * scale of the texture coordinates; positive angles turn the texture clockwise in the picture.
void set_transform(const TextureReference& reference, double (&rows)[2][3]) {
  const double c = std::cos(reference.rotation), s = std::sin(reference.rotation);
  const double values[2][3] = {{c * reference.scale.x, s * reference.scale.y, reference.offset.x},
                               {-s * reference.scale.x, c * reference.scale.y, reference.offset.y}};
  for (int i = 0; i < 6; ++i) rows[i / 3][i % 3] = values[i / 3][i % 3];
}

TextureUse texture_use(const Scene& scene, const TextureReference& reference, const std::vector<Pixels>& images) {
  TextureUse use;
  if (reference.texture < 0) return use;
  const Texture& texture = entry(scene.textures, reference.texture, "texture");
  if (texture.image < 0) return use;
  const Pixels& pixels = entry(images, texture.image, "image");
  if (pixels.rgba.empty()) return use;
  use.pixels = &pixels;
  if (texture.sampler >= 0) {
    const Sampler& sampler = entry(scene.samplers, texture.sampler, "sampler");
    use.wrap_s = wrap_of(sampler.wrap_s);
    use.wrap_t = wrap_of(sampler.wrap_t);
    use.nearest = sampler.mag_filter == 9728;
  }
  use.texcoord = reference.texcoord;
  set_transform(reference, use.transform);
  return use;
}

Look look_of(const Scene& scene, const Material& material, const std::vector<Pixels>& images) {
  Look look;
  look.base_color = material.base_color;
  look.emissive = material.emissive;
  look.base = texture_use(scene, material.base_texture, images);
  look.glow = texture_use(scene, material.emissive_texture, images);
  look.alpha_mode = material.alpha_mode;
  look.alpha_cutoff = material.alpha_cutoff;
  look.double_sided = material.double_sided;
  look.unlit = material.unlit;
  return look;
}

void mark_image(const Scene& scene, const TextureReference& reference, std::vector<char>& used) {
  if (reference.texture < 0) return;
  const int image = entry(scene.textures, reference.texture, "texture").image;
  if (image < 0) return;
  entry(scene.images, image, "image");
  used[std::size_t(image)] = 1;
}

std::string name_of(const Scene& scene, std::size_t image) {
  const Image& entry = scene.images[image];
  return !entry.name.empty() ? entry.name : !entry.uri.empty() ? entry.uri : std::to_string(image);
}

/// Decodes what the drawn materials read, and nothing else.
void decode_used(const Scene& scene, const std::vector<char>& drawn, Parts& parts) {
  std::vector<char> used(scene.images.size(), 0);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    if (drawn[i]) {
      mark_image(scene, scene.materials[i].base_texture, used);
      mark_image(scene, scene.materials[i].emissive_texture, used);
    }
  parts.images.resize(scene.images.size());
  std::vector<std::string> defects(scene.images.size());
  parallel_each(parts.images.size(), 1, [&](std::size_t i) {
    try {
      if (used[i]) parts.images[i] = decode_image(scene.images[i].bytes, name_of(scene, i));
    } catch (const Error& error) {
      defects[i] = error.what();
    }
  });
  for (const std::string& defect : defects)
    if (!defect.empty()) parts.warnings.push_back(defect + "; drawn white");
}

/// The attribute if it holds one value of an allowed size for every vertex.
const Attribute* usable(const Primitive& primitive, const std::string& name, int least, int most) {
  const Attribute* attribute = find_attribute(primitive, name);
  if (!attribute || attribute->components < least || attribute->components > most) return nullptr;
  const bool complete = attribute->values.size() == primitive.positions.size() * std::size_t(attribute->components);
  return complete ? attribute : nullptr;
}

Part make_part(const Primitive& primitive, const Look& look) {
  Part part;
  part.primitive = &primitive;
  part.look = &look;
  part.normal = usable(primitive, "NORMAL", 3, 3);
  part.color = usable(primitive, "COLOR_0", 3, 4);
  part.base_uv = usable(primitive, "TEXCOORD_" + std::to_string(look.base.texcoord), 2, 2);
  part.glow_uv = usable(primitive, "TEXCOORD_" + std::to_string(look.glow.texcoord), 2, 2);
  part.source = usable(primitive, "_SOURCE_POSITION", 3, 3);
  return part;
}

void check_indices(const Primitive& primitive) {
  for (const std::uint32_t index : primitive.indices)
    if (index >= primitive.positions.size())
      throw Error(ErrorCode::input, "scene: index " + std::to_string(index) + " of a primitive with " +
                                        std::to_string(primitive.positions.size()) + " vertices");
}

/// Calls visit(instance index, instance, primitive, triangles of the instance before it) for all that is drawn, points
/// and lines included.
template <typename Visit>
void for_each_primitive(const Scene& scene, Visit&& visit) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    std::uint32_t first = 0;
    for (const Primitive& primitive : entry(scene.meshes, scene.instances[i].mesh, "mesh").primitives) {
      visit(i, scene.instances[i], primitive, first);
      if (primitive.topology == Topology::triangles) first += static_cast<std::uint32_t>(primitive.indices.size() / 3);
    }
  }
}

std::vector<char> drawn_materials(const Scene& scene) {
  std::vector<char> drawn(scene.materials.size(), 0);
  for_each_primitive(scene, [&](std::size_t, const Instance&, const Primitive& primitive, std::uint32_t) {
    if (primitive.material < 0) return;
    entry(scene.materials, primitive.material, "material");
    drawn[std::size_t(primitive.material)] = 1;
  });
  return drawn;
}

} // namespace

Parts prepare_parts(const Scene& scene) {
  Parts result;
  const std::vector<char> drawn = drawn_materials(scene);
  decode_used(scene, drawn, result);
  result.looks.resize(scene.materials.size() + 1);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    if (drawn[i]) result.looks[i + 1] = look_of(scene, scene.materials[i], result.images);
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) check_indices(primitive);
  for_each_primitive(
      scene, [&](std::size_t i, const Instance& instance, const Primitive& primitive, std::uint32_t first) {
        Part part = make_part(primitive, result.looks[std::size_t(std::max(primitive.material + 1, 0))]);
        part.world = instance.world;
        part.object = static_cast<std::uint32_t>(i + 1);
        part.first_triangle = first;
        (primitive.topology == Topology::triangles ? result.parts : result.strokes).push_back(part);
      });
  return result;
}

} // namespace domewarp
