// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/refine/edge_oracle.h"
#include "domewarp/refine/refine.h"
#include "domewarp/scene/scene.h"
#include "domewarp/scene/view.h"

namespace domewarp {

inline constexpr const char* source_position = "_SOURCE_POSITION";

/// The position as it is written: w (x', y', -1) for perspective output, (x', y', -depth) for orthographic.
Vec3f warped_position(const MappedPoint& point, Projection projection);

/// The attributes of a primitive that are carried over: those that somebody reads, unless all are asked for.
std::vector<const Attribute*> written_attributes(const Primitive& primitive, const RefineOptions& options);

/// Counts what a written primitive keeps and leaves out.
void count_attributes(const Primitive& source, const std::vector<const Attribute*>& written, SkipReport& skipped);

/// Turns directions of a mesh into eye space; other attributes pass as they are.
class AttributeWriter {
public:
  AttributeWriter(const View& view, const Mat4& world);

  /// Whether an attribute's values change with the space they are in.
  static bool turns(const Attribute& attribute) { return attribute.name == "NORMAL" || attribute.name == "TANGENT"; }

  /// Writes one vertex' values of an attribute, `attribute.components` of them. @param values in the space of the mesh
  void write(const Attribute& attribute, const double* values, float* out) const;

private:
  Mat3 directions_, normals_;
};

} // namespace domewarp
