// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"

namespace domewarp {

/// One vertex attribute other than the position, as glTF names it: NORMAL, TANGENT, TEXCOORD_n, COLOR_n, _ANYTHING.
/// `values` is n x components, dequantised to float (COLOR in linear 0..1, 3 or 4 components; NORMAL unit; TANGENT xyzw).
struct Attribute {
  std::string name;
  int components = 0;
  std::vector<float> values;
};

enum class Topology { points, lines, triangles };

/// A part of a mesh with one material. Strips, fans and loops have already become lists, missing indices 0..n-1.
struct Primitive {
  Topology topology = Topology::triangles;
  int material = -1;                  ///< index into Scene::materials, -1 for glTF's default material
  std::vector<Vec3f> positions;       ///< n, in the space of the mesh
  std::vector<Attribute> attributes;  ///< each n x components
  std::vector<std::uint32_t> indices; ///< 1, 2 or 3 per element, every one < n
  bool keeps_order = false;           ///< vertices and triangles stand in the order of the file they come from, some left out
  std::string extras = {};            ///< what the file says beyond glTF, as JSON text, empty when absent; so below
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
  std::string extras = {};
};

/// One drawing of a mesh: a node of the glTF file (an object that is drawn), with its transformation to world space.
/// Instancing shows as several instances of one mesh.
struct Instance {
  std::string name;
  int mesh = 0;
  Mat4 world = Mat4(1);
  std::string extras = {};       ///< of the node
};

/// A camera node. It looks along the -z axis of `world`, y up.
struct Camera {
  std::string name;
  Mat4 world = Mat4(1);
  bool perspective = true;
  double yfov = 0;               ///< radians, perspective only
  double aspect = 0;             ///< width / height, 0 when the file leaves it open; perspective only
  double xmag = 0, ymag = 0;     ///< half extents, orthographic only
  double znear = 0;
  double zfar = 0;               ///< 0 for an infinite perspective
};

enum class LightKind { directional, point, spot };

/// KHR_lights_punctual. It shines along the -z axis of `world`.
struct Light {
  std::string name;
  LightKind kind = LightKind::point;
  Mat4 world = Mat4(1);
  Vec3 color = Vec3(1);
  double intensity = 1;          ///< candela (point, spot) or lux (directional)
  double range = 0;              ///< metres, 0 for no limit
  double inner_cone = 0, outer_cone = 0.7853981633974483; ///< radians
};

/// An image file, byte for byte. `uri` is empty when it was embedded in a buffer or data URI.
struct Image {
  std::string name;
  std::string mime;              ///< image/png, image/jpeg, image/webp, ...
  std::string uri;               ///< as the source file spells it (percent-encoded), relative to the source file
  std::vector<std::uint8_t> bytes;
  std::string extras = {};
};

/// Wrap and filter are glTF's numbers (10497 repeat, 33071 clamp, 33648 mirror; 9728 nearest, 9729 linear, ...; 0 unset).
struct Sampler {
  int wrap_s = 10497, wrap_t = 10497;
  int mag_filter = 0, min_filter = 0;
  std::string extras = {};
};

struct Texture {
  int image = -1;                ///< the image to draw; a WebP source of EXT_texture_webp is preferred
  int sampler = -1;              ///< -1: repeat, linear
  std::string json;              ///< the texture object of the source file, untouched
};

/// How a material refers to a texture, KHR_texture_transform included.
struct TextureReference {
  int texture = -1;              ///< -1: none
  int texcoord = 0;
  Vec2 offset = Vec2(0), scale = Vec2(1);
  double rotation = 0;           ///< radians, counter-clockwise
};

enum class AlphaMode { opaque, mask, blend };

/// What the renderers use of a material, and the whole of it as text for the writer.
struct Material {
  std::string name;
  Vec4 base_color = Vec4(1);     ///< linear
  TextureReference base_texture; ///< sRGB
  Vec3 emissive = Vec3(0);       ///< linear, KHR_materials_emissive_strength included
  TextureReference emissive_texture;
  double metallic = 1, roughness = 1;
  AlphaMode alpha_mode = AlphaMode::opaque;
  double alpha_cutoff = 0.5;
  bool double_sided = false;
  bool unlit = false;
  std::string json;              ///< the material object of the source file, untouched
};

/// A glTF scene, flattened to what is drawn. Materials, textures, images and samplers stand
/// in the order of the source file, so the indices inside `json` texts stay valid; unused entries may be present.
struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Camera> cameras;
  std::vector<Light> lights;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Image> images;
  std::vector<Sampler> samplers;
  std::string copyright;         ///< asset.copyright
  std::size_t animations = 0;    ///< of the source file, of which the scene shows one moment
  std::string extras;            ///< asset.extras.domewarp as JSON text, empty when absent
  std::string asset_extras;      ///< the rest of asset.extras, an object
  std::string scene_extras;      ///< of the scene that is drawn
  std::string root_extras;       ///< of the file
  std::vector<std::string> dropped_extras;     ///< what else has extras, which are not carried through: "cameras", "skins", ...
  std::vector<std::string> dropped_extensions; ///< named in the source file, neither understood nor carried through
  std::vector<std::string> warnings;           ///< one sentence each
};

/// The triangles that are drawn, instances multiplied out.
std::size_t count_triangles(const Scene& scene);

/// The vertices of what is drawn, instances multiplied out.
std::size_t count_vertices(const Scene& scene);

/// The attribute of this name, or null.
const Attribute* find_attribute(const Primitive& primitive, const std::string& name);

/// Axis-aligned box of everything that is drawn, in world space; nothing when no finite vertex is drawn.
struct Box {
  Vec3 low, high;
};
std::optional<Box> bounding_box(const Scene& scene);

} // namespace domewarp
