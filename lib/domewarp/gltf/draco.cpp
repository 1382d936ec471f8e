// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/draco.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>

namespace domewarp::gltf {

namespace {

/// Draco allocates what the head of a stream claims before it looks at the rest. Regular meshes do compress to a small
/// fraction of a bit per triangle, so the bound is a generous ratio over a floor of 4 million.
void check_claim(std::uint64_t claimed, std::size_t stream_bytes, const char* what, const std::string& place,
                 Budget& budget) {
  if (claimed > std::max<std::uint64_t>(std::uint64_t(1) << 22, 256 * static_cast<std::uint64_t>(stream_bytes)))
    refuse(place, "claims " + std::to_string(claimed) + " " + what + " in " + std::to_string(stream_bytes) + " bytes");
  budget.charge(static_cast<std::size_t>(claimed), 48, place);
}

std::uint64_t varint(std::span<const std::uint8_t> stream, std::size_t& offset) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && offset < stream.size(); shift += 7) {
    const std::uint8_t byte = stream[offset++];
    value |= static_cast<std::uint64_t>(byte & 127) << shift;
    if (byte < 128) break;
  }
  return value;
}

/// Reads the counts at the head of a mesh stream: "DRACO", version, kind, method, flags, then (edgebreaker) traversal
/// type, vertices, faces or (sequential) faces, points. Metadata would stand before the counts; glTF has none.
void check_head(std::span<const std::uint8_t> stream, const std::string& place, Budget& budget) {
  if (stream.size() < 13 || std::memcmp(stream.data(), "DRACO", 5) != 0) refuse(place, "is not a Draco stream");
  const int version = stream[5] * 256 + stream[6];
  const bool edgebreaker = stream[8] == 1, has_metadata = (stream[10] & 0x80) != 0;
  if (stream[7] != 1 || stream[8] > 1) refuse(place, "is a Draco stream without a mesh");
  if (has_metadata) refuse(place, "has Draco metadata, which glTF does not allow");
  if (version < 0x0202)
    refuse(place, "is of Draco's bitstream version " + std::to_string(stream[5]) + "." + std::to_string(stream[6]) +
                      ", older than glTF's 2.2");
  std::size_t offset = edgebreaker ? 12 : 11;
  const std::uint64_t first = varint(stream, offset), second = varint(stream, offset);
  check_claim(first, stream.size(), edgebreaker ? "vertices" : "triangles", place, budget);
  check_claim(second, stream.size(), edgebreaker ? "triangles" : "vertices", place, budget);
}

/// Draco's decoder, asking before it allocates: the head of a stream does not tell how large its attributes are.
template <typename Base>
class BoundedDecoder : public Base {
 public:
  BoundedDecoder(const std::string& place, Budget& budget) : place_(place), budget_(budget) {}

 protected:
  bool DecodeAllAttributes() override {
    std::size_t vertex_bytes = 0;
    for (int i = 0; i < this->point_cloud()->num_attributes(); ++i)
      vertex_bytes += static_cast<std::size_t>(this->point_cloud()->attribute(i)->byte_stride()) + largest_workspace;
    budget_.charge(this->point_cloud()->num_points(), vertex_bytes, place_);
    return Base::DecodeAllAttributes();
  }

 private:
  /// Bytes per vertex and attribute for maps, predictions and the quantised copy of a value of four components.
  static constexpr std::size_t largest_workspace = 40;
  const std::string& place_;
  Budget& budget_;
};

template <typename Decoder>
std::unique_ptr<draco::Mesh> decode_mesh(std::span<const std::uint8_t> stream, const std::string& place,
                                         Budget& budget) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
  auto mesh = std::make_unique<draco::Mesh>();
  const draco::Status status =
      BoundedDecoder<Decoder>(place, budget).Decode(draco::DecoderOptions(), &buffer, mesh.get());
  if (!status.ok()) refuse(place, std::string("is not a valid Draco stream: ") + status.error_msg());
  return mesh;
}

template <typename T>
void copy_values(const draco::PointAttribute& attribute, std::size_t vertices, DracoAttribute& result) {
  const auto components = static_cast<std::size_t>(attribute.num_components());
  std::vector<T> element(components);
  for (std::size_t i = 0; i < vertices; ++i) {
    const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    std::memcpy(element.data(), attribute.GetAddress(index), components * sizeof(T));
    for (std::size_t c = 0; c < components; ++c) result.values[i * components + c] = static_cast<double>(element[c]);
  }
}

DracoAttribute copy_attribute(const draco::PointAttribute& attribute, const std::string& name, std::size_t vertices,
                              const std::string& place, Budget& budget) {
  DracoAttribute result{name, attribute.num_components(), {}};
  budget.charge(vertices, sizeof(double) * static_cast<std::size_t>(result.components), place);
  result.values.resize(vertices * static_cast<std::size_t>(result.components));
  for (std::size_t i = 0; i < vertices; ++i)
    if (attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i))).value() >= attribute.size())
      refuse(place, "has a value of " + name + " that is not in its table");
  switch (attribute.data_type()) {
  case draco::DT_INT8:
    copy_values<std::int8_t>(attribute, vertices, result);
    break;
  case draco::DT_UINT8:
    copy_values<std::uint8_t>(attribute, vertices, result);
    break;
  case draco::DT_INT16:
    copy_values<std::int16_t>(attribute, vertices, result);
    break;
  case draco::DT_UINT16:
    copy_values<std::uint16_t>(attribute, vertices, result);
    break;
  case draco::DT_INT32:
    copy_values<std::int32_t>(attribute, vertices, result);
    break;
  case draco::DT_UINT32:
    copy_values<std::uint32_t>(attribute, vertices, result);
    break;
  case draco::DT_FLOAT32:
    copy_values<float>(attribute, vertices, result);
    break;
  default:
    refuse(place, "has " + name + " in a Draco data type that glTF does not have");
  }
  return result;
}

std::vector<std::uint32_t> copy_indices(const draco::Mesh& mesh, const std::string& place) {
  std::vector<std::uint32_t> indices;
  indices.reserve(std::size_t(3) * mesh.num_faces());
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i)
    for (const draco::PointIndex& point : mesh.face(draco::FaceIndex(i))) {
      if (point.value() >= mesh.num_points())
        refuse(place, "has the index " + std::to_string(point.value()) + " of " + std::to_string(mesh.num_points()) +
                          " vertices");
      indices.push_back(point.value());
    }
  return indices;
}

} // namespace

DracoMesh decode_draco(std::span<const std::uint8_t> stream, const AttributeMap& ids, const std::string& place,
                       Budget& budget) {
  check_head(stream, place, budget);
  const bool edgebreaker = stream[8] == 1;
  const std::unique_ptr<draco::Mesh> decoded = edgebreaker
                                                   ? decode_mesh<draco::MeshEdgebreakerDecoder>(stream, place, budget)
                                                   : decode_mesh<draco::MeshSequentialDecoder>(stream, place, budget);
  const draco::Mesh& mesh = *decoded;
  DracoMesh result;
  result.vertices = mesh.num_points();
  result.indices = copy_indices(mesh, place);
  for (const auto& [name, id] : ids) {
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
    if (!attribute) refuse(place, "has no attribute with the id " + std::to_string(id) + " of " + name);
    result.attributes.push_back(copy_attribute(*attribute, name, result.vertices, place, budget));
  }
  return result;
}

} // namespace domewarp::gltf
