// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/warped_vertex.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace domewarp {

namespace {

Vec3f unit_or_zero(const Vec3& v) {
  const double length = glm::length(v);
  return length > 0 ? Vec3f(v / length) : Vec3f(0);
}

/// Cofactor matrix: turns normals, also for mirrored matrices up to the sign that winding has already taken care of.
Mat3 cofactors(const Mat3& m) {
  const Mat3 c(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0 ? -c : c;
}

} // namespace

Vec3f warped_position(const MappedPoint& point, Projection projection) {
  if (projection == Projection::orthographic) return Vec3f(Vec3(point.mapped.image, -glm::length(point.eye)));
  return Vec3f(Vec3(point.mapped.image * point.mapped.weight, -point.mapped.weight));
}

std::vector<const Attribute*> written_attributes(const Primitive& primitive, const RefineOptions& options) {
  std::vector<const Attribute*> written;
  for (const Attribute& attribute : primitive.attributes)
    if (attribute.name != source_position &&
        (!options.skip.unused_attributes || !options.reads || options.reads(primitive.material, attribute.name)))
      written.push_back(&attribute);
  return written;
}

void count_attributes(const Primitive& source, const std::vector<const Attribute*>& written, SkipReport& skipped) {
  const auto attributes = static_cast<std::size_t>(
      std::count_if(source.attributes.begin(), source.attributes.end(), [](const Attribute& a) { return a.name != source_position; }));
  skipped.attributes += attributes;
  skipped.unused_attributes += attributes - written.size();
}

AttributeWriter::AttributeWriter(const View& view, const Mat4& world)
    : directions_(Mat3(world_to_eye(view)) * Mat3(world)), normals_(cofactors(directions_)) {}

void AttributeWriter::write(const Attribute& attribute, const double* values, float* out) const {
  int done = 0;
  if (attribute.name == "NORMAL" || attribute.name == "TANGENT") {
    const Vec3 v(values[0], values[1], values[2]);
    const Vec3f turned = unit_or_zero(attribute.name == "NORMAL" ? normals_ * v : directions_ * v);
    for (; done < 3; ++done) out[done] = turned[done];
  }
  for (; done < attribute.components; ++done) out[done] = static_cast<float>(values[done]);
}

} // namespace domewarp
