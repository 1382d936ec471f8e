// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <draco/compression/expert_encode.h>
#include <draco/core/quantization_utils.h>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/draco.h"
#include "domewarp/gltf/layout.h"

namespace domewarp::gltf {

namespace {

draco::GeometryAttribute::Type kind_of(const std::string& name) {
  if (name == "POSITION") return draco::GeometryAttribute::POSITION;
  if (name == "NORMAL") return draco::GeometryAttribute::NORMAL;
  if (name.starts_with("TEXCOORD_")) return draco::GeometryAttribute::TEX_COORD;
  if (name.starts_with("COLOR_")) return draco::GeometryAttribute::COLOR;
  return draco::GeometryAttribute::GENERIC;
}

int add_attribute(draco::Mesh& mesh, const std::string& name, int components, const float* values, std::size_t count) {
  draco::GeometryAttribute geometry;
  geometry.Init(kind_of(name), nullptr, static_cast<std::uint8_t>(components), draco::DT_FLOAT32, false,
                static_cast<std::int64_t>(sizeof(float)) * components, 0);
  const int id = mesh.AddAttribute(geometry, true, static_cast<draco::AttributeValueIndex::ValueType>(count));
  draco::PointAttribute& attribute = *mesh.attribute(id);
  for (std::size_t i = 0; i < count; ++i)
    attribute.SetAttributeValue(draco::AttributeValueIndex(static_cast<std::uint32_t>(i)),
                                values + i * static_cast<std::size_t>(components));
  return id;
}

void set_faces(draco::Mesh& mesh, const std::vector<std::uint32_t>& indices) {
  mesh.SetNumFaces(indices.size() / 3);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    mesh.SetFace(draco::FaceIndex(static_cast<std::uint32_t>(i / 3)),
                 {draco::PointIndex(indices[i]), draco::PointIndex(indices[i + 1]), draco::PointIndex(indices[i + 2])});
}

/// Texture coordinates to 2^-14 of a texture. 0: exact, for those that hardly differ (Draco divides by their range) or
/// repeat a texture more than 32 times: Draco's entropy coder keeps a table of as many entries as a value has.
int texcoord_bits(const Attribute& attribute) {
  const auto [low, high] = std::minmax_element(attribute.values.begin(), attribute.values.end());
  const double range = static_cast<double>(*high) - static_cast<double>(*low);
  return range > 1e-9 && range < 32 ? std::ilogb(std::max(range, 1e-3)) + 15 : 0;
}

/// Directions and colours to what eyes tell apart; attributes of our own exactly.
void set_quantization(draco::ExpertEncoder& encoder, int id, const Attribute& attribute) {
  constexpr float zeros[4] = {0, 0, 0, 0};
  if (attribute.name == "NORMAL") encoder.SetAttributeQuantization(id, 10);
  if (attribute.name.starts_with("COLOR_"))
    encoder.SetAttributeExplicitQuantization(id, 12, attribute.components, zeros, 1);
  if (!attribute.name.starts_with("TEXCOORD_")) return;
  if (const int bits = texcoord_bits(attribute)) encoder.SetAttributeQuantization(id, bits);
}

float range_of(const PositionGrid& grid) {
  return static_cast<float>(grid.range);
}

/// What becomes of a number among Draco's options.
double kept(double number) {
  return static_cast<double>(std::stof(std::to_string(static_cast<float>(number))));
}

draco::Status encode(const draco::Mesh& mesh, const AttributeMap& ids, const std::vector<Attribute>& attributes,
                     const PositionGrid& grid, draco::EncoderBuffer& buffer) {
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(5, 5);
  const Vec3f origin(grid.origin);
  encoder.SetAttributeExplicitQuantization(ids.front().second, grid.bits, 3, &origin.x, range_of(grid));
  for (std::size_t i = 1; i < ids.size(); ++i) set_quantization(encoder, ids[i].second, attributes[i - 1]);
  buffer.Clear();
  return encoder.EncodeToBuffer(&buffer);
}

std::vector<double> bounds(const DracoAttribute& attribute, bool high) {
  std::vector<double> bound(attribute.values.begin(), attribute.values.begin() + attribute.components);
  for (std::size_t i = 0; i < attribute.values.size(); ++i) {
    double& b = bound[i % static_cast<std::size_t>(attribute.components)];
    b = high ? std::max(b, attribute.values[i]) : std::min(b, attribute.values[i]);
  }
  return bound;
}

} // namespace

PositionGrid draco_grid(const PositionGrid& grid) {
  PositionGrid result = grid;
  result.is_draco = true;
  const auto nudge = [](double number) { return std::max(5e-7, std::abs(number) * 1e-7); };
  double excess = 0;
  for (int c = 0; c < 3; ++c) {
    double& origin = result.origin[c];
    while (kept(origin) > grid.origin[c]) origin -= nudge(origin);
    origin = kept(origin);
    excess = std::max(excess, grid.origin[c] - origin);
  }
  while (kept(result.range) < grid.range + excess) result.range += nudge(result.range);
  result.range = kept(result.range);
  if (!(result.range < 3e38))
    throw Error(ErrorCode::output, "the positions reach too far for Draco's single precision");
  return result;
}

GridPoint to_draco_grid(const PositionGrid& grid, const Vec3f& position) {
  draco::Quantizer quantizer;
  quantizer.Init(range_of(grid), (1 << grid.bits) - 1);
  const Vec3f offset = position - Vec3f(grid.origin);
  return {quantizer(offset.x), quantizer(offset.y), quantizer(offset.z)};
}

Vec3f from_draco_grid(const PositionGrid& grid, const GridPoint& point) {
  draco::Dequantizer dequantizer;
  dequantizer.Init(range_of(grid), (1 << grid.bits) - 1);
  return Vec3f(dequantizer(point.x), dequantizer(point.y), dequantizer(point.z)) + Vec3f(grid.origin);
}

void compress_primitive(const std::vector<Vec3f>& positions, const std::vector<Attribute>& attributes,
                        const std::vector<std::uint32_t>& indices, const PositionGrid& grid, Layout& layout,
                        WrittenPrimitive& written) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(positions.size()));
  set_faces(mesh, indices);
  AttributeMap ids = {{"POSITION", add_attribute(mesh, "POSITION", 3, &positions.front().x, positions.size())}};
  for (const Attribute& attribute : attributes)
    ids.emplace_back(attribute.name, add_attribute(mesh, attribute.name, attribute.components, attribute.values.data(),
                                                   positions.size()));
  draco::EncoderBuffer buffer;
  const draco::Status status = encode(mesh, ids, attributes, grid, buffer);
  if (!status.ok())
    throw Error(ErrorCode::output, std::string("Draco cannot compress a primitive: ") + status.error_msg());
  const std::span stream(reinterpret_cast<const std::uint8_t*>(buffer.data()), buffer.size());
  Budget budget(SIZE_MAX);
  AttributeMap unique_ids;
  for (const auto& [name, id] : ids) unique_ids.emplace_back(name, static_cast<int>(mesh.attribute(id)->unique_id()));
  // What a reader will see: the bounds must be those of the decoded positions.
  const DracoMesh decoded = decode_draco(stream, unique_ids, "Draco", budget);
  written.draco_view = layout.add_view(stream);
  written.draco_attributes = {unique_ids.begin(), unique_ids.end()};
  for (const DracoAttribute& attribute : decoded.attributes) {
    WrittenAccessor accessor{-1, decoded.vertices, 5126, type_name(attribute.components), false, {}, {}};
    if (attribute.name == "POSITION") accessor.low = bounds(attribute, false), accessor.high = bounds(attribute, true);
    written.attributes.emplace_back(attribute.name, layout.add_accessor(std::move(accessor)));
  }
  written.indices = layout.add_accessor({-1, decoded.indices.size(), 5125, "SCALAR", false, {}, {}});
}

} // namespace domewarp::gltf
