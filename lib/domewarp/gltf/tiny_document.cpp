// SPDX-License-Identifier: Apache-2.0
// The only place that sees tinygltf. Debian's libdraco exports a differently configured tinygltf of its own, so ours
// is compiled here under another name, without image decoder, Draco or file access.
#include "domewarp/gltf/tiny_document.h"

#include <array>
#include <charconv>
#include <fstream> // tinygltf forgets it
#include <sstream>

#include <nlohmann/json.hpp>

#define tinygltf domewarp_tinygltf
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/nodes.h"

namespace domewarp::gltf {

namespace tiny = domewarp_tinygltf;

namespace {

std::vector<std::uint8_t> fetch(const Blobs& blobs, const std::string& name) {
  const bool is_buffer = name.starts_with("buffer/");
  const std::size_t slash = name.find('/');
  std::size_t index = 0;
  std::from_chars(name.data() + slash + 1, name.data() + name.size(), index);
  return is_buffer ? blobs.buffer(index) : blobs.image(index);
}

bool exists(const std::string& name, void*) {
  return name.starts_with("buffer/") || name.starts_with("image/");
}

std::string expand(const std::string& name, void*) {
  return name;
}

bool read_whole(std::vector<unsigned char>* out, std::string*, const std::string& name, void* blobs) {
  *out = fetch(*static_cast<const Blobs*>(blobs), name);
  return !out->empty();
}

bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

bool keep_image(tiny::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
                void*) {
  image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

AttributeMap attribute_map(const std::map<std::string, int>& attributes) {
  return {attributes.begin(), attributes.end()};
}

Accessor convert(const tiny::Accessor& source) {
  Accessor accessor;
  accessor.view = source.bufferView;
  accessor.offset = source.byteOffset;
  accessor.count = source.count;
  accessor.component_type = source.componentType;
  accessor.normalized = source.normalized;
  const bool matrix = source.type >= TINYGLTF_TYPE_MAT2 && source.type <= TINYGLTF_TYPE_MAT4;
  accessor.columns = matrix ? source.type - TINYGLTF_TYPE_MAT2 + 2 : 1;
  accessor.rows = matrix ? accessor.columns : tiny::GetNumComponentsInType(static_cast<std::uint32_t>(source.type));
  accessor.low = source.minValues;
  accessor.high = source.maxValues;
  if (!source.sparse.isSparse) return accessor;
  accessor.sparse = {static_cast<std::size_t>(source.sparse.count),
                     source.sparse.indices.bufferView,
                     source.sparse.values.bufferView,
                     static_cast<std::size_t>(source.sparse.indices.byteOffset),
                     static_cast<std::size_t>(source.sparse.values.byteOffset),
                     source.sparse.indices.componentType};
  return accessor;
}

MeshSource convert(const tiny::Mesh& source) {
  MeshSource mesh{source.name, {}, source.weights};
  for (const tiny::Primitive& primitive : source.primitives) {
    PrimitiveSource& added = mesh.primitives.emplace_back();
    added.attributes = attribute_map(primitive.attributes);
    added.indices = primitive.indices;
    added.material = primitive.material;
    added.mode = primitive.mode;
    for (const std::map<std::string, int>& target : primitive.targets) added.targets.push_back(attribute_map(target));
  }
  return mesh;
}

NodeSource convert(const tiny::Node& source) {
  NodeSource node;
  node.name = source.name;
  node.local = source.matrix.size() == 16 ? matrix_of(source.matrix)
                                          : matrix_of(source.translation, source.rotation, source.scale);
  node.has_matrix = source.matrix.size() == 16;
  node.translation = source.translation;
  node.rotation = source.rotation;
  node.scale = source.scale;
  node.camera = source.camera;
  node.mesh = source.mesh;
  node.skin = source.skin;
  node.children = source.children;
  node.weights = source.weights;
  return node;
}

Camera convert(const tiny::Camera& source) {
  Camera camera;
  camera.name = source.name;
  camera.perspective = source.type == "perspective";
  if (camera.perspective) {
    camera.yfov = source.perspective.yfov;
    camera.aspect = source.perspective.aspectRatio;
    camera.znear = source.perspective.znear;
    camera.zfar = source.perspective.zfar;
  } else {
    camera.xmag = source.orthographic.xmag;
    camera.ymag = source.orthographic.ymag;
    camera.znear = source.orthographic.znear;
    camera.zfar = source.orthographic.zfar;
  }
  return camera;
}

void convert(tiny::Model& model, Document& document) {
  for (tiny::Buffer& buffer : model.buffers) document.buffers.push_back(std::move(buffer.data));
  for (const tiny::BufferView& view : model.bufferViews)
    document.views.push_back({view.buffer, view.byteOffset, view.byteLength, view.byteStride, {}});
  for (const tiny::Accessor& accessor : model.accessors) document.accessors.push_back(convert(accessor));
  for (const tiny::Mesh& mesh : model.meshes) document.meshes.push_back(convert(mesh));
  for (const tiny::Node& node : model.nodes) document.nodes.push_back(convert(node));
  for (const tiny::Skin& skin : model.skins) document.skins.push_back({skin.joints, skin.inverseBindMatrices});
  for (const tiny::Scene& scene : model.scenes) document.scenes.push_back({scene.name, scene.nodes});
  document.default_scene = model.defaultScene;
  for (const tiny::Camera& camera : model.cameras) document.scene.cameras.push_back(convert(camera));
  for (const tiny::Sampler& sampler : model.samplers)
    document.scene.samplers.push_back(
        {sampler.wrapS, sampler.wrapT, std::max(sampler.magFilter, 0), std::max(sampler.minFilter, 0)});
  for (tiny::Image& image : model.images)
    document.scene.images.push_back({image.name, image.mimeType, {}, std::move(image.image)});
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

} // namespace

void load_tiny(const std::string& json, const Blobs& blobs, Document& document) {
  tiny::TinyGLTF loader;
  loader.SetImageLoader(keep_image, nullptr);
  loader.SetFsCallbacks({exists, expand, read_whole, write_nothing, const_cast<Blobs*>(&blobs)});
  tiny::Model model;
  std::string error, warning;
  const auto length = static_cast<unsigned int>(json.size());
  if (!loader.LoadASCIIFromString(&model, &error, &warning, json.data(), length, "", tiny::REQUIRE_VERSION))
    throw Error(ErrorCode::input, error.empty() ? "cannot be parsed as glTF" : first_line(error));
  convert(model, document);
}

} // namespace domewarp::gltf
