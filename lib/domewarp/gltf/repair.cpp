// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/gltf/primitives.h"

namespace domewarp::gltf {

namespace {

Vec3 vector_at(const Attribute& attribute, std::size_t vertex) {
  const float* values = attribute.values.data() + vertex * static_cast<std::size_t>(attribute.components);
  return {values[0], values[1], values[2]};
}

void store(Attribute& attribute, std::size_t vertex, const Vec3& vector) {
  for (std::size_t i = 0; i < 3; ++i)
    attribute.values[vertex * static_cast<std::size_t>(attribute.components) + i] =
        static_cast<float>(vector[static_cast<int>(i)]);
}

/// Sum of the areas' normals of the triangles around each vertex; +z where there are none.
std::vector<Vec3> mean_normals(const Primitive& primitive) {
  std::vector<Vec3> normals(primitive.positions.size(), Vec3(0));
  for (std::size_t i = 0; primitive.topology == Topology::triangles && i + 2 < primitive.indices.size(); i += 3) {
    const Vec3 a(primitive.positions[primitive.indices[i]]), b(primitive.positions[primitive.indices[i + 1]]),
        c(primitive.positions[primitive.indices[i + 2]]);
    const Vec3 normal = glm::cross(b - a, c - a);
    for (std::size_t k = 0; k < 3; ++k) normals[primitive.indices[i + k]] += normal;
  }
  for (Vec3& normal : normals) {
    const double length = glm::length(normal);
    normal = length > 0 && std::isfinite(length) ? normal / length : Vec3(0, 0, 1);
  }
  return normals;
}

struct Count {
  std::size_t not_unit = 0, without_direction = 0;
};

/// Makes vectors unit; fallback(vertex) gives a direction to those that have none. What is unit to the tolerance of
/// the Khronos validator is left alone to the bit.
template <typename Fallback>
Count make_unit(Attribute& attribute, Fallback&& fallback) {
  constexpr double tolerance = 0.00674, float_tolerance = 1e-6;
  std::atomic<std::size_t> not_unit = 0;
  std::vector<std::uint8_t> has_none(attribute.values.size() / static_cast<std::size_t>(attribute.components), 0);
  parallel_ranges(has_none.size(), 4096, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 vector = vector_at(attribute, i);
      const double length = glm::length(vector);
      has_none[i] = !(length > 0 && std::isfinite(length));
      if (has_none[i]) continue;
      here += std::abs(length - 1) > tolerance;
      if (std::abs(length - 1) > float_tolerance) store(attribute, i, vector / length);
    }
    not_unit += here;
  });
  Count count{not_unit, 0};
  for (std::size_t i = 0; i < has_none.size(); ++i)
    if (has_none[i]) {
      ++count.without_direction;
      store(attribute, i, fallback(i));
    }
  return count;
}

void warn(const Count& count, const std::string& place, std::vector<std::string>& warnings) {
  if (count.not_unit)
    warnings.push_back(place + ": " + std::to_string(count.not_unit) + " vectors are not unit; they are normalised");
  if (count.without_direction)
    warnings.push_back(place + ": " + std::to_string(count.without_direction) +
                       " vectors have no direction; they are replaced");
}

void repair_normals(Primitive& primitive, Attribute& normals, const std::string& place,
                    std::vector<std::string>& warnings) {
  std::vector<Vec3> means;
  const Count count = make_unit(normals, [&](std::size_t vertex) {
    if (means.empty()) means = mean_normals(primitive);
    return means[vertex];
  });
  warn(count, place, warnings);
}

/// Any direction across the normal, where the file has none.
Vec3 across(const Vec3& normal) {
  return glm::normalize(glm::cross(normal, std::abs(normal.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
}

void repair_tangents(const Attribute* normals, Attribute& tangents, const std::string& place,
                     std::vector<std::string>& warnings) {
  Count count = make_unit(
      tangents, [&](std::size_t vertex) { return normals ? across(vector_at(*normals, vertex)) : Vec3(1, 0, 0); });
  std::size_t signs = 0;
  for (std::size_t i = 3; i < tangents.values.size(); i += 4) {
    float& sign = tangents.values[i];
    if (sign == 1 || sign == -1) continue;
    sign = sign < 0 ? -1.0f : 1.0f;
    ++signs;
  }
  warn(count, place, warnings);
  if (signs)
    warnings.push_back(place + ": " + std::to_string(signs) + " handedness values are not 1 or -1; they are rounded");
}

void repair_values(Attribute& attribute, const std::string& place, std::vector<std::string>& warnings) {
  std::size_t count = 0;
  for (float& value : attribute.values)
    if (!std::isfinite(value)) value = 0, ++count;
  if (count) warnings.push_back(place + ": " + std::to_string(count) + " values are not finite; they are set to 0");
  if (!attribute.name.starts_with("COLOR_")) return;
  const auto outside = std::count_if(attribute.values.begin(), attribute.values.end(),
                                     [](float value) { return value < 0 || value > 1; });
  for (float& value : attribute.values) value = std::clamp(value, 0.0f, 1.0f);
  if (outside) warnings.push_back(place + ": " + std::to_string(outside) + " values are not in 0..1; they are clamped");
}

} // namespace

void repair_attributes(Primitive& primitive, const std::string& place, std::vector<std::string>& warnings) {
  Attribute* normals = nullptr;
  for (Attribute& attribute : primitive.attributes)
    if (attribute.name == "NORMAL") normals = &attribute;
  if (normals) repair_normals(primitive, *normals, place + ".NORMAL", warnings);
  for (Attribute& attribute : primitive.attributes) {
    const std::string here = place + "." + attribute.name;
    if (attribute.name == "TANGENT")
      repair_tangents(normals, attribute, here, warnings);
    else if (attribute.name != "NORMAL")
      repair_values(attribute, here, warnings);
  }
}

} // namespace domewarp::gltf
