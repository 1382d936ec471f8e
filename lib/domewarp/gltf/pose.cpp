// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/pose.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/gltf/accessors.h"
#include "domewarp/gltf/nodes.h"

namespace domewarp::gltf {

namespace {

Attribute* find_mutable(Primitive& primitive, const std::string& name) {
  for (Attribute& attribute : primitive.attributes)
    if (attribute.name == name) return &attribute;
  return nullptr;
}

void add_to_positions(Primitive& primitive, const std::vector<float>& displacements, double weight) {
  for (std::size_t i = 0; i < primitive.positions.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      float& value = primitive.positions[i][c];
      value = static_cast<float>(value + weight * displacements[3 * i + static_cast<std::size_t>(c)]);
    }
}

/// A tangent's displacement has three components, its handedness stays.
void add_to_attribute(Attribute& attribute, std::size_t components, const std::vector<float>& displacements,
                      double weight) {
  const auto stride = static_cast<std::size_t>(attribute.components);
  for (std::size_t i = 0; i < displacements.size() / components; ++i)
    for (std::size_t c = 0; c < components; ++c) {
      float& value = attribute.values[i * stride + c];
      value = static_cast<float>(value + weight * displacements[i * components + c]);
    }
}

void apply_target(const Document& document, const AttributeMap& target, double weight, const std::string& place,
                  Budget& budget, std::vector<std::string>& warnings, Primitive& primitive) {
  for (const auto& [name, index] : target) {
    Attribute* attribute = find_mutable(primitive, name);
    if (!attribute && name != "POSITION") {
      warnings.push_back(place + "." + name + ": moves an attribute that the primitive does not have");
      continue;
    }
    const Accessor& accessor = document.accessors[static_cast<std::size_t>(index)];
    if (name == "POSITION" && (accessor.low.empty() || accessor.high.empty()))
      warnings.push_back(place + ".POSITION: has no min and max");
    const auto components = static_cast<std::size_t>(accessor.components());
    const std::size_t expected =
        name == "POSITION" || name == "TANGENT" ? 3 : static_cast<std::size_t>(attribute->components);
    if (components != expected) refuse(place + "." + name, "has " + std::to_string(components) + " components");
    if (accessor.count != primitive.positions.size())
      refuse(place + "." + name, "has " + std::to_string(accessor.count) + " vertices, POSITION has " +
                                     std::to_string(primitive.positions.size()));
    if (weight == 0) continue;
    const std::vector<float> displacements = read_floats(document, index, budget);
    if (name == "POSITION")
      add_to_positions(primitive, displacements, weight);
    else
      add_to_attribute(*attribute, components, displacements, weight);
  }
}

void check_finite(const Primitive& primitive, const std::string& place, const char* by) {
  for (const Vec3f& p : primitive.positions)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      refuse(place, std::string("has a vertex that ") + by + " moves to infinity");
}

} // namespace

void apply_morph_targets(const Document& document, const PrimitiveSource& source, const std::vector<double>& weights,
                         const std::string& place, Budget& budget, std::vector<std::string>& warnings,
                         Primitive& primitive) {
  if (!weights.empty() && weights.size() != source.targets.size())
    warnings.push_back(place + ": has " + std::to_string(source.targets.size()) + " morph targets for " +
                       std::to_string(weights.size()) + " weights");
  for (std::size_t i = 0; i < source.targets.size(); ++i)
    apply_target(document, source.targets[i], i < weights.size() ? weights[i] : 0,
                 place + ".targets[" + std::to_string(i) + "]", budget, warnings, primitive);
  if (!source.targets.empty()) check_finite(primitive, place, "a morph target");
}

std::vector<Mat4> joint_matrices(const Document& document, int index, const std::vector<Mat4>& world, Budget& budget,
                                 std::vector<std::string>& warnings) {
  const SkinSource& skin = document.skins[static_cast<std::size_t>(index)];
  const std::string place = at("skins", static_cast<std::size_t>(index));
  budget.charge(skin.joints.size(), sizeof(Mat4), place);
  std::vector<float> inverse;
  if (skin.inverse_bind_matrices >= 0) {
    if (document.accessors[static_cast<std::size_t>(skin.inverse_bind_matrices)].components() != 16)
      refuse(place + ".inverseBindMatrices", "are no 4 x 4 matrices");
    inverse = read_floats(document, skin.inverse_bind_matrices, budget);
    if (inverse.size() / 16 < skin.joints.size())
      refuse(place + ".inverseBindMatrices",
             "has " + std::to_string(inverse.size() / 16) + " for " + std::to_string(skin.joints.size()) + " joints");
  }
  std::vector<Mat4> matrices;
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    const auto joint = static_cast<std::size_t>(skin.joints[i]);
    Mat4 bind(1);
    if (!inverse.empty())
      bind = matrix_of(std::vector<double>(inverse.begin() + static_cast<std::ptrdiff_t>(16 * i),
                                           inverse.begin() + static_cast<std::ptrdiff_t>(16 * i + 16)));
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r)
        if (!std::isfinite(bind[c][r])) refuse(place + ".inverseBindMatrices", "is not finite at " + std::to_string(i));
      if (bind[c][3] == (c == 3 ? 1 : 0)) continue;
      warnings.push_back(place + ".inverseBindMatrices: matrix " + std::to_string(i) +
                         " is not affine; its last row is ignored");
      bind[c][3] = c == 3 ? 1 : 0;
    }
    matrices.push_back(world[joint] * bind);
  }
  return matrices;
}

namespace {

struct Blend {
  Mat4 matrix = Mat4(0);
  double weight = 0;
};

Blend blend_of(const std::vector<Influences>& influences, const std::vector<Mat4>& joints, std::size_t vertex,
               const std::string& place) {
  Blend blend;
  for (const Influences& set : influences)
    for (std::size_t i = 4 * vertex; i < 4 * vertex + 4; ++i) {
      const double weight = set.weights[i];
      if (weight == 0) continue;
      if (!std::isfinite(weight)) refuse(place + ".WEIGHTS_0", "is not finite at vertex " + std::to_string(vertex));
      if (set.joints[i] >= joints.size())
        refuse(place + ".JOINTS_0",
               "refers to joint " + std::to_string(set.joints[i]) + " of " + std::to_string(joints.size()));
      blend.matrix += joints[set.joints[i]] * weight;
      blend.weight += weight;
    }
  return blend;
}

/// Cofactors: the inverse transpose up to scale, and defined for flat matrices too.
Mat3 normal_matrix(const Mat4& matrix) {
  const Vec3 x(matrix[0]), y(matrix[1]), z(matrix[2]);
  return Mat3(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
}

void turn(Attribute* attribute, std::size_t vertex, const Mat3& matrix) {
  if (!attribute) return;
  float* values = attribute->values.data() + vertex * static_cast<std::size_t>(attribute->components);
  const Vec3 turned = matrix * Vec3(values[0], values[1], values[2]);
  for (int c = 0; c < 3; ++c) values[c] = static_cast<float>(turned[c]);
}

} // namespace

void apply_skin(const std::vector<Influences>& influences, const std::vector<Mat4>& joints, const std::string& place,
                std::vector<std::string>& warnings, Primitive& primitive) {
  Attribute* normals = find_mutable(primitive, "NORMAL");
  Attribute* tangents = find_mutable(primitive, "TANGENT");
  std::size_t unbalanced = 0;
  for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
    Blend blend = blend_of(influences, joints, i, place);
    // Weights stored as bytes add up to 1 within 4 x 0.5 / 255.
    unbalanced += std::abs(blend.weight - 1) > 0.01;
    if (blend.weight == 0) {
      const std::uint32_t first = influences.front().joints[4 * i];
      if (first >= joints.size())
        refuse(place + ".JOINTS_0",
               "refers to joint " + std::to_string(first) + " of " + std::to_string(joints.size()));
      blend = {joints[first], 1};
    }
    const Mat4 matrix = blend.matrix * (1 / blend.weight);
    primitive.positions[i] = Vec3f(Vec3(matrix * Vec4(Vec3(primitive.positions[i]), 1)));
    const Mat3 turning = normal_matrix(matrix);
    turn(normals, i, turning);
    turn(tangents, i, Mat3(matrix));
  }
  if (unbalanced)
    warnings.push_back(place + ".WEIGHTS_0: the weights of " + std::to_string(unbalanced) +
                       " vertices do not add up to 1; they are scaled");
  check_finite(primitive, place, "its skin");
}

} // namespace domewarp::gltf
