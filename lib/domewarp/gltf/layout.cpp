// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/layout.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/gltf/topology.h"

namespace domewarp::gltf {

namespace {

constexpr int vertex_target = 34962, index_target = 34963;
constexpr int uint8_type = 5121, uint16_type = 5123, uint32_type = 5125, int8_type = 5120;

template <typename T>
std::span<const std::uint8_t> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

Vec3 direction_at(const Attribute& attribute, std::size_t vertex) {
  const float* values = attribute.values.data() + vertex * static_cast<std::size_t>(attribute.components);
  return {values[0], values[1], values[2]};
}

/// Leaves alone what float32 can call unit, so that writing what was read changes nothing.
void normalise(Attribute& attribute) {
  const auto components = static_cast<std::size_t>(attribute.components);
  parallel_each(attribute.values.size() / components, 4096, [&](std::size_t i) {
    const Vec3 direction = direction_at(attribute, i);
    const double length = glm::length(direction);
    if (components == 4) attribute.values[i * components + 3] = attribute.values[i * components + 3] < 0 ? -1.0f : 1.0f;
    if (std::abs(length - 1) <= 1e-6) return;
    const Vec3 unit = length > 0 && std::isfinite(length) ? direction / length : Vec3(0, 0, 1);
    for (std::size_t c = 0; c < 3; ++c)
      attribute.values[i * components + c] = static_cast<float>(unit[static_cast<int>(c)]);
  });
}

void make_finite(Attribute& attribute) {
  const bool is_color = attribute.name.starts_with("COLOR_");
  parallel_each(attribute.values.size(), 16384, [&](std::size_t i) {
    float& value = attribute.values[i];
    if (!std::isfinite(value)) value = 0;
    if (is_color) value = std::clamp(value, 0.0f, 1.0f);
  });
}

/// Whether a stream is smaller, with what the document says of it.
bool pays(const MeshoptStream& stream, std::size_t plain_bytes) {
  constexpr std::size_t text_bytes = 160;
  return stream.bytes.size() + text_bytes < plain_bytes;
}

} // namespace

int Layout::add_view(std::span<const std::uint8_t> data, int target, std::size_t stride) {
  bytes.resize((bytes.size() + 3) / 4 * 4);
  views.push_back({bytes.size(), data.size(), stride, target, {}});
  bytes.insert(bytes.end(), data.begin(), data.end());
  return static_cast<int>(views.size() - 1);
}

int Layout::add_vertices(std::span<const std::uint8_t> data, std::size_t count, std::size_t stride) {
  if (!use_meshopt) return add_view(data, vertex_target, stride);
  MeshoptStream stream = encode_vertices(data, count, data.size() / count);
  return pays(stream, data.size()) ? add_stream(std::move(stream), vertex_target) : add_view(data, vertex_target, stride);
}

int Layout::add_stream(MeshoptStream stream, int target) {
  const std::size_t decoded = stream.count * stream.stride;
  const int index = add_view(stream.bytes, target, target == vertex_target ? stream.stride : 0);
  WrittenView& view = views.back();
  view.meshopt_offset = std::exchange(view.offset, fallback_bytes);
  view.meshopt_length = std::exchange(view.length, decoded);
  view.meshopt = {{}, stream.mode, stream.count, stream.stride};
  fallback_bytes += (decoded + 3) / 4 * 4;
  return index;
}

int Layout::add_accessor(WrittenAccessor accessor) {
  accessors.push_back(std::move(accessor));
  return static_cast<int>(accessors.size() - 1);
}

std::string type_name(int components) {
  switch (components) {
  case 1:
    return "SCALAR";
  case 2:
    return "VEC2";
  case 3:
    return "VEC3";
  case 4:
    return "VEC4";
  case 9:
    return "MAT3";
  case 16:
    return "MAT4";
  default:
    throw Error(ErrorCode::output,
                "an attribute with " + std::to_string(components) + " components cannot be written as glTF");
  }
}

namespace {

/// glTF numbers the sets of colours without gaps.
bool follows_others(const Primitive& primitive, const std::string& color) {
  const int number = std::stoi(color.substr(6));
  for (int lower = 0; lower < number; ++lower)
    if (!find_attribute(primitive, "COLOR_" + std::to_string(lower))) return false;
  return true;
}

} // namespace

std::vector<Attribute> writable_attributes(const Primitive& primitive) {
  std::vector<Attribute> attributes;
  const bool has_normals = find_attribute(primitive, "NORMAL") != nullptr;
  for (const Attribute& attribute : primitive.attributes) {
    if (attribute.name == "TANGENT" && !has_normals) continue;
    // Renderers look at COLOR_0 only; a renamed COLOR_1 would change the picture.
    if (attribute.name.starts_with("COLOR_") && !follows_others(primitive, attribute.name)) continue;
    Attribute& added = attributes.emplace_back(attribute);
    make_finite(added);
    if (added.name == "NORMAL" || added.name == "TANGENT") normalise(added);
  }
  return attributes;
}

namespace {

int add_floats(Layout& layout, const std::vector<float>& values, int components) {
  const std::size_t count = values.size() / static_cast<std::size_t>(components);
  return layout.add_accessor(
      {layout.add_vertices(bytes_of(values), count), count, 5126, type_name(components), false, {}, {}});
}

int add_positions(Layout& layout, const std::vector<Vec3f>& positions) {
  Vec3f low(std::numeric_limits<float>::infinity()), high(-std::numeric_limits<float>::infinity());
  for (const Vec3f& p : positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error(ErrorCode::output, "a position that is not finite cannot be written as glTF");
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return layout.add_accessor({layout.add_vertices(bytes_of(positions), positions.size()),
                              positions.size(),
                              5126,
                              "VEC3",
                              false,
                              {low.x, low.y, low.z},
                              {high.x, high.y, high.z}});
}

template <typename T>
int add_indices_as(Layout& layout, const std::vector<std::uint32_t>& indices, int component_type) {
  std::vector<T> narrow(indices.size());
  std::transform(indices.begin(), indices.end(), narrow.begin(),
                 [](std::uint32_t index) { return static_cast<T>(index); });
  return layout.add_accessor(
      {layout.add_view(bytes_of(narrow), index_target), indices.size(), component_type, "SCALAR", false, {}, {}});
}

/// @return -1 where they are smaller as they are. The decoder knows no indices of 8 bits.
int add_compressed_indices(Layout& layout, const std::vector<std::uint32_t>& indices, bool are_triangles, std::uint32_t largest) {
  const bool are_wide = largest >= 0xFFFF;
  MeshoptStream stream = encode_indices(indices, are_triangles, are_wide ? 4 : 2);
  if (!pays(stream, indices.size() * (are_wide ? 4 : largest < 0xFF ? 1 : 2))) return -1;
  const int view = layout.add_stream(std::move(stream), index_target);
  return layout.add_accessor({view, indices.size(), are_wide ? uint32_type : uint16_type, "SCALAR", false, {}, {}});
}

/// The largest value of each type restarts a primitive, so it cannot be an index.
int add_indices(Layout& layout, const std::vector<std::uint32_t>& indices, bool are_triangles) {
  const std::uint32_t largest = *std::max_element(indices.begin(), indices.end());
  if (layout.use_meshopt)
    if (const int compressed = add_compressed_indices(layout, indices, are_triangles, largest); compressed >= 0) return compressed;
  if (largest < 0xFF) return add_indices_as<std::uint8_t>(layout, indices, uint8_type);
  if (largest < 0xFFFF) return add_indices_as<std::uint16_t>(layout, indices, uint16_type);
  return layout.add_accessor({layout.add_view(bytes_of(indices), index_target), indices.size(), uint32_type, "SCALAR", false, {}, {}});
}

/// Integers in elements that are padded to a multiple of four bytes.
template <typename T>
int add_integers(Layout& layout, const std::vector<double>& values, int components, int component_type,
                 bool normalized) {
  const auto used = static_cast<std::size_t>(components);
  const std::size_t stride = (used * sizeof(T) + 3) / 4 * 4, count = values.size() / used;
  std::vector<std::uint8_t> bytes(count * stride);
  WrittenAccessor accessor{-1,
                           count,
                           component_type,
                           type_name(components),
                           normalized,
                           std::vector<double>(used, 1e300),
                           std::vector<double>(used, -1e300)};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const T value = static_cast<T>(values[i]);
    std::memcpy(bytes.data() + i / used * stride + i % used * sizeof(T), &value, sizeof(T));
    accessor.low[i % used] = std::min(accessor.low[i % used], static_cast<double>(value));
    accessor.high[i % used] = std::max(accessor.high[i % used], static_cast<double>(value));
  }
  accessor.view = layout.add_vertices(bytes, count, stride == used * sizeof(T) ? 0 : stride);
  if (normalized) accessor.low.clear(), accessor.high.clear();
  return layout.add_accessor(std::move(accessor));
}

int add_grid_positions(Layout& layout, const std::vector<Vec3f>& positions, const PositionGrid& grid) {
  std::vector<double> values;
  for (const Vec3f& p : positions) {
    const GridPoint point = to_grid(grid, p);
    for (int c = 0; c < 3; ++c) values.push_back(point[c]);
  }
  return add_integers<std::uint16_t>(layout, values, 3, uint16_type, false);
}

std::vector<double> scaled(const std::vector<float>& values, double factor) {
  std::vector<double> result(values.size());
  std::transform(values.begin(), values.end(), result.begin(),
                 [&](float value) { return std::round(static_cast<double>(value) * factor); });
  return result;
}

bool lies_in_unit_range(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return value >= 0 && value <= 1; });
}

/// Directions as bytes, texture coordinates as 16 bits where they do not repeat. Colours as 16 bits: they are linear, and
/// a step of 1/255 near black is 13 steps of the display.
int add_quantized(Layout& layout, const Attribute& attribute) {
  if (attribute.name == "NORMAL" || attribute.name == "TANGENT")
    return add_integers<std::int8_t>(layout, scaled(attribute.values, 127), attribute.components, int8_type, true);
  if (attribute.name.starts_with("COLOR_"))
    return add_integers<std::uint16_t>(layout, scaled(attribute.values, 65535), attribute.components, uint16_type, true);
  if (attribute.name.starts_with("TEXCOORD_") && lies_in_unit_range(attribute.values))
    return add_integers<std::uint16_t>(layout, scaled(attribute.values, 65535), attribute.components, uint16_type,
                                       true);
  return add_floats(layout, attribute.values, attribute.components);
}

/// glTF numbers the sets of texture coordinates without gaps, and a material's textures must find theirs. Zeros cost
/// no bytes: an accessor without a view.
void fill_texcoords(std::size_t vertices, int texcoords, Layout& layout, WrittenPrimitive& written) {
  std::set<int> present;
  for (const auto& [name, accessor] : written.attributes)
    if (name.starts_with("TEXCOORD_")) present.insert(std::stoi(name.substr(9)));
  const int count = std::max(texcoords, present.empty() ? 0 : *present.rbegin() + 1);
  int zeros = -1;
  for (int set = 0; set < count; ++set) {
    if (present.contains(set)) continue;
    if (zeros < 0) zeros = layout.add_accessor({-1, vertices, 5126, "VEC2", false, {}, {}});
    written.attributes.emplace_back("TEXCOORD_" + std::to_string(set), zeros);
  }
}

} // namespace

namespace {

/// Draco's edgebreaker holds triangles, and has no answer when all of them are degenerate.
bool can_compress(const std::vector<std::uint32_t>& indices, Topology topology) {
  if (topology != Topology::triangles) return false;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    if (indices[i] != indices[i + 1] && indices[i + 1] != indices[i + 2] && indices[i + 2] != indices[i]) return true;
  return false;
}

} // namespace

WrittenPrimitive write_primitive(const Primitive& primitive, bool mirrored, int texcoords, Packing packing,
                                 const PositionGrid& grid, Layout& layout) {
  WrittenPrimitive written;
  written.material = primitive.material;
  written.mode = primitive.topology == Topology::points ? 0 : primitive.topology == Topology::lines ? 1 : 4;
  std::vector<std::uint32_t> reversed;
  if (mirrored) {
    reversed = primitive.indices;
    reverse_triangles(reversed, primitive.topology);
  }
  const std::vector<std::uint32_t>& indices = mirrored ? reversed : primitive.indices;
  const std::vector<Attribute> attributes = writable_attributes(primitive);
  std::size_t vertices = primitive.positions.size();
  if (packing == Packing::draco && can_compress(indices, primitive.topology)) {
    compress_primitive(primitive.positions, attributes, indices, grid, layout, written);
    vertices = layout.accessors[static_cast<std::size_t>(written.attributes.front().second)].count;
  } else {
    const bool quantized = packing == Packing::quantized;
    std::vector<Vec3f> snapped;
    if (packing == Packing::draco) // Draco cannot hold it, but the file has one grid
      for (const Vec3f& position : primitive.positions) snapped.push_back(Vec3f(from_grid(grid, to_grid(grid, position))));
    const std::vector<Vec3f>& positions = packing == Packing::draco ? snapped : primitive.positions;
    written.attributes.emplace_back("POSITION", quantized ? add_grid_positions(layout, positions, grid)
                                                          : add_positions(layout, positions));
    for (const Attribute& attribute : attributes)
      written.attributes.emplace_back(attribute.name, quantized
                                                          ? add_quantized(layout, attribute)
                                                          : add_floats(layout, attribute.values, attribute.components));
    written.indices = add_indices(layout, indices, primitive.topology == Topology::triangles);
  }
  fill_texcoords(vertices, texcoords, layout, written);
  return written;
}

} // namespace domewarp::gltf
