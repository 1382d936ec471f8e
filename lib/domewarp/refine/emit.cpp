// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/emit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/t_junctions.h"
#include "domewarp/refine/hidden_faces.h"
#include "domewarp/refine/picture_rectangle.h"
#include "domewarp/refine/warped_vertex.h"

namespace domewarp {

namespace {

/// Attribute values of the derived wedges that the output needs, in the space of their mesh, components of all
/// attributes of the part side by side. A wedge's parents come before it, so one ascending pass is enough.
class WedgeValues {
public:
  WedgeValues(const Scene& scene, const Soup& soup, const RefinedMesh& refined, const std::vector<std::uint8_t>& drawn,
              const RefineOptions& options)
      : scene_(scene), soup_(soup), refined_(refined), first_derived_(static_cast<std::uint32_t>(soup.wedge_point.size())) {
    const std::uint32_t count = static_cast<std::uint32_t>(soup.extra_wedges.size() + refined.wedges.size());
    std::vector<std::uint8_t> needed(drawn.begin() + first_derived_, drawn.end());
    for (std::uint32_t i = count; i-- > 0;)
      if (needed[i])
        for (const std::uint32_t parent : derived(first_derived_ + i).parent)
          if (parent >= first_derived_) needed[parent - first_derived_] = 1;
    for (const SoupPart& part : soup.parts) {
      written_.push_back(written_attributes(primitive(part), options));
      int stride = 0;
      for (const Attribute* attribute : written_.back()) stride += attribute->components;
      stride_.push_back(stride);
    }
    offset_.assign(count, 0);
    std::size_t size = 0;
    for (std::uint32_t i = 0; i < count; ++i)
      if (needed[i]) {
        offset_[i] = size;
        size += stride_[derived(first_derived_ + i).part];
      }
    values_.resize(size);
    parent_.resize(stride_.empty() ? 0 : *std::max_element(stride_.begin(), stride_.end()));
    for (std::uint32_t i = 0; i < count; ++i)
      if (needed[i]) blend(first_derived_ + i, &values_[offset_[i]]);
  }

  /// Copies the values of one wedge, `stride(part)` of them.
  void get(std::uint32_t wedge, std::uint32_t part, double* out) const {
    if (wedge >= first_derived_) {
      std::copy_n(&values_[offset_[wedge - first_derived_]], stride_[part], out);
      return;
    }
    const std::size_t vertex = wedge - soup_.parts[part].first_wedge;
    for (const Attribute* attribute : written_[part])
      for (int c = 0; c < attribute->components; ++c) *out++ = attribute->values[vertex * attribute->components + c];
  }

  int stride(std::uint32_t part) const { return stride_[part]; }

  /// In the order of the values.
  const std::vector<const Attribute*>& written(std::uint32_t part) const { return written_[part]; }

  const Primitive& primitive(const SoupPart& part) const {
    return scene_.meshes[scene_.instances[part.instance].mesh].primitives[part.primitive];
  }

private:
  const Wedge& derived(std::uint32_t wedge) const {
    const std::uint32_t i = wedge - first_derived_;
    return i < soup_.extra_wedges.size() ? soup_.extra_wedges[i] : refined_.wedges[i - soup_.extra_wedges.size()];
  }

  void blend(std::uint32_t id, double* out) {
    const Wedge& wedge = derived(id);
    const int stride = stride_[wedge.part];
    std::fill_n(out, stride, 0.0);
    for (int k = 0; k < 3; ++k) {
      if (wedge.weight[k] == 0) continue;
      get(wedge.parent[k], wedge.part, parent_.data());
      for (int c = 0; c < stride; ++c) out[c] += wedge.weight[k] * parent_[c];
    }
  }

  const Scene& scene_;
  const Soup& soup_;
  const RefinedMesh& refined_;
  std::uint32_t first_derived_;
  std::vector<std::vector<const Attribute*>> written_; ///< per part
  std::vector<int> stride_;          ///< per part
  std::vector<std::size_t> offset_;  ///< per derived wedge
  std::vector<double> values_;
  std::vector<double> parent_;       ///< scratch
};

bool is_off_picture(const RefinedMesh& refined, const RefinedFace& face, const Vec2& half_extent) {
  const auto image = [&](int k) { return refined.points[face.point[k]].mapped.image; };
  return is_beyond(std::array{image(0), image(1), image(2)}, half_extent);
}

constexpr std::uint32_t no_vertex = 0xffffffff;

/// A vertex that the output needs, before anything of it is computed.
struct Corner {
  std::uint32_t wedge, point;
  std::uint32_t face;           ///< of the soup, the first that uses it
  std::uint32_t next;           ///< vertex of the same wedge with another colour, or no_vertex
};

struct PartOutput {
  Primitive primitive;
  std::size_t zero_area = 0;
  double smallest_depth = std::numeric_limits<double>::infinity(), largest_depth = 0;
};

/// Everything that the parts of one branch are emitted from.
struct EmitJob {
  const Scene& scene;
  const View& view;
  const Soup& soup;
  const RefinedMesh& refined;
  const RefineOptions& options;
  const WedgeValues& values;
  int orientation;
  std::vector<std::uint32_t>& vertex_of; ///< per wedge: its first vertex in the part, or no_vertex
};

/// One part of the output: first its triangles and which vertices they need, then the vertices, in parallel.
class PartEmitter {
public:
  PartEmitter(const EmitJob& job, std::uint32_t part)
      : job_(job), part_(part), source_(job.values.primitive(job.soup.parts[part])),
        writer_(job.view, job.scene.instances[job.soup.parts[part].instance].world),
        has_normals_(find_attribute(source_, "NORMAL") != nullptr) {}

  /// @param faces indices into refined.faces, all of the part
  PartOutput emit(std::span<const std::uint32_t> faces) {
    PartOutput out;
    out.primitive.material = source_.material;
    out.primitive.indices.reserve(3 * faces.size());
    for (const std::uint32_t f : faces) add_face(job_.refined.faces[f], out);
    fill_positions(out);
    fill_attributes(out.primitive);
    if (job_.options.vertex_colour) fill_colours(out.primitive);
    return out;
  }

private:
  void add_face(const RefinedFace& face, PartOutput& out) {
    if (job_.options.skip.zero_area && has_equal_corners(face)) {
      ++out.zero_area;
      return;
    }
    for (int k = 0; k < 3; ++k) {
      const int corner = job_.orientation < 0 ? 2 - k : k;
      out.primitive.indices.push_back(vertex(face.wedge[corner], face.point[corner], face.source));
    }
  }

  bool has_equal_corners(const RefinedFace& face) const {
    const auto position = [&](int k) { return warped_position(job_.refined.points[face.point[k]], job_.options.projection); };
    const Vec3f a = position(0), b = position(1), c = position(2);
    return a == b || b == c || c == a;
  }

  std::uint32_t vertex(std::uint32_t wedge, std::uint32_t point, std::uint32_t face) {
    for (std::uint32_t v = job_.vertex_of[wedge]; v != no_vertex; v = corners_[v].next)
      if (!job_.options.vertex_colour || look_alike(corners_[v].face, face)) return v;
    corners_.push_back({wedge, point, face, job_.vertex_of[wedge]});
    return job_.vertex_of[wedge] = static_cast<std::uint32_t>(corners_.size() - 1);
  }

  /// Whether a vertex can have one colour for both faces: without normals of their own only if it is one face, else if
  /// the same side is seen of both.
  bool look_alike(std::uint32_t f, std::uint32_t g) const {
    return f == g || (has_normals_ && is_seen_from_behind(f) == is_seen_from_behind(g));
  }

  Vec3 normal_of(const SoupFace& face) const {
    const std::vector<Vec3>& p = job_.soup.points;
    return glm::cross(p[face.point[1]] - p[face.point[0]], p[face.point[2]] - p[face.point[0]]);
  }

  bool is_seen_from_behind(std::uint32_t f) const {
    const SoupFace& face = job_.soup.faces[f];
    return glm::dot(normal_of(face), job_.soup.points[face.point[0]]) > 0;
  }

  void fill_positions(PartOutput& out) const {
    std::vector<Vec3f>& positions = out.primitive.positions;
    positions.resize(corners_.size());
    parallel_each(positions.size(), 1024, [&](std::size_t i) {
      positions[i] = warped_position(job_.refined.points[corners_[i].point], job_.options.projection);
    });
    for (const Vec3f& position : positions) {
      out.smallest_depth = std::min(out.smallest_depth, static_cast<double>(-position.z));
      out.largest_depth = std::max(out.largest_depth, static_cast<double>(-position.z));
    }
  }

  void fill_attributes(Primitive& out) const {
    const std::vector<const Attribute*>& kept = job_.values.written(part_);
    for (const Attribute* attribute : kept)
      out.attributes.push_back({attribute->name, attribute->components, std::vector<float>(corners_.size() * attribute->components)});
    parallel_ranges(corners_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      std::vector<double> values(job_.values.stride(part_));
      for (std::size_t i = begin; i < end; ++i) {
        job_.values.get(corners_[i].wedge, part_, values.data());
        const double* at = values.data();
        for (std::size_t k = 0; k < kept.size(); ++k) {
          writer_.write(*kept[k], at, &out.attributes[k].values[i * kept[k]->components]);
          at += kept[k]->components;
        }
      }
    });
    if (!job_.options.source_attributes) return;
    std::vector<float>& source = out.attributes.emplace_back(source_position, 3, std::vector<float>(3 * corners_.size())).values;
    for (std::size_t i = 0; i < corners_.size(); ++i)
      for (int c = 0; c < 3; ++c) source[3 * i + c] = static_cast<float>(job_.refined.points[corners_[i].point].eye[c]);
  }

  /// Replaces COLOR_0 by what the caller makes of it.
  void fill_colours(Primitive& out) const {
    const Attribute* given = find_attribute(out, "COLOR_0");
    const Attribute* normals = find_attribute(out, "NORMAL");
    const int components = given != nullptr && given->components == 4 ? 4 : 3;
    std::vector<float> colours(corners_.size() * components);
    parallel_each(corners_.size(), 64, [&](std::size_t i) {
      const SoupFace& face = job_.soup.faces[corners_[i].face];
      const std::vector<Vec3>& p = job_.soup.points;
      VertexToColour vertex;
      vertex.instance = job_.soup.parts[part_].instance;
      vertex.primitive = job_.soup.parts[part_].primitive;
      vertex.eye = job_.refined.points[corners_[i].point].eye;
      vertex.face_normal = normal_of(face);
      vertex.face_centre = (p[face.point[0]] + p[face.point[1]] + p[face.point[2]]) / 3.0;
      vertex.normal = normals == nullptr ? vertex.face_normal : Vec3(normals->values[3 * i], normals->values[3 * i + 1], normals->values[3 * i + 2]);
      for (int c = 0; given != nullptr && c < given->components; ++c) vertex.colour[c] = given->values[i * given->components + c];
      const Vec4 colour = job_.options.vertex_colour(vertex);
      for (int c = 0; c < components; ++c) colours[i * components + c] = static_cast<float>(colour[c]);
    });
    std::erase_if(out.attributes, [](const Attribute& attribute) { return attribute.name == "COLOR_0"; });
    out.attributes.push_back({"COLOR_0", components, std::move(colours)});
  }

  const EmitJob& job_;
  std::uint32_t part_;
  const Primitive& source_;
  AttributeWriter writer_;
  bool has_normals_;
  std::vector<Corner> corners_;
};

} // namespace

void emit(const Scene& scene, const View& view, const Soup& soup, const RefinedMesh& refined, int orientation,
          const Raster& raster, const RefineOptions& options, Scene& out, RefineReport& report) {
  const Vec2 half_extent = kept_half_extent(options, raster);
  std::vector<std::uint8_t> hidden(refined.faces.size(), 0);
  if (options.is_hidden)
    parallel_each(hidden.size(), 256, [&](std::size_t f) { hidden[f] = is_hidden(refined, refined.faces[f], options); });
  std::vector<std::vector<std::uint32_t>> faces_of(soup.parts.size());
  std::vector<std::uint8_t> drawn(soup.wedge_point.size() + soup.extra_wedges.size() + refined.wedges.size(), 0);
  for (std::uint32_t f = 0; f < refined.faces.size(); ++f) {
    const RefinedFace& face = refined.faces[f];
    if (options.skip.off_picture && is_off_picture(refined, face, half_extent)) {
      ++report.skipped.off_picture;
      continue;
    }
    if (hidden[f]) {
      ++report.skipped.hidden;
      continue;
    }
    faces_of[soup.faces[face.source].part].push_back(f);
    for (const std::uint32_t wedge : face.wedge) drawn[wedge] = 1;
  }
  const WedgeValues values(scene, soup, refined, drawn, options);
  std::vector<std::uint32_t> vertex_of(drawn.size(), no_vertex);
  const EmitJob job{scene, view, soup, refined, options, values, orientation, vertex_of};
  std::vector<PartOutput> outputs(soup.parts.size());
  parallel_each(outputs.size(), 1, [&](std::size_t part) {
    if (!faces_of[part].empty()) outputs[part] = PartEmitter(job, static_cast<std::uint32_t>(part)).emit(faces_of[part]);
  });
  for (std::size_t part = 0; part < outputs.size(); ++part) {
    PartOutput& output = outputs[part];
    report.skipped.zero_area += output.zero_area;
    if (output.primitive.indices.empty()) continue;
    count_attributes(values.primitive(soup.parts[part]), values.written(static_cast<std::uint32_t>(part)), report.skipped);
    report.triangles_out += output.primitive.indices.size() / 3;
    report.vertices += output.primitive.positions.size();
    report.smallest_depth = report.smallest_depth > 0 ? std::min(report.smallest_depth, output.smallest_depth) : output.smallest_depth;
    report.largest_depth = std::max(report.largest_depth, output.largest_depth);
    out.meshes[soup.parts[part].instance].primitives.push_back(std::move(output.primitive));
  }
}

void audit_edges(const Soup& soup, const RefinedMesh& refined, const EdgeOracle& oracle, const Raster& raster,
                 const RefineOptions& options, RefineReport& report) {
  std::vector<std::uint32_t> faces(refined.edges.size(), 0);
  for (const RefinedFace& face : refined.faces)
    for (const std::uint32_t edge : face.edge) ++faces[edge];
  const float tolerance = static_cast<float>(oracle.options().tolerance);
  const VisibleRegion& region = oracle.region();
  const auto is_rim = [&](const RefinedEdge& edge) {
    for (std::size_t i = 0; i < region.boundaries.size(); ++i)
      if (refined.points[edge.a].sides[i] == 0 && refined.points[edge.b].sides[i] == 0) return true;
    return false;
  };
  const Vec2 half_extent = kept_half_extent(options, raster);
  std::vector<float> errors;
  MeshTopology open;
  for (std::size_t e = 0; e < faces.size(); ++e) {
    if (faces[e] == 0) continue;
    const RefinedEdge& edge = refined.edges[e];
    errors.push_back(edge.error);
    report.depth_error_max = std::max(report.depth_error_max, static_cast<double>(edge.depth_error));
    report.uncertified_edges += !edge.certified || edge.error * (1 - 1e-6f) > tolerance;
    if (faces[e] != 1 || is_rim(edge)) continue;
    if (is_beyond(std::array{refined.points[edge.a].mapped.image, refined.points[edge.b].mapped.image}, half_extent)) continue; // its other face may have been dropped
    open.edges.push_back({edge.a, edge.b, 1});
    if (edge.source != RefinedEdge::none && soup.topology.edges[edge.source].faces == 1) continue;
    ++report.open_edges;
    report.max_gap_px = std::max(report.max_gap_px, 2 * edge.error / pixel_size(raster));
  }
  std::vector<Vec3> points(refined.points.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = refined.points[i].eye;
  report.t_junctions_out += find_t_junctions(points, open).size();
  add_errors(errors, raster, report);
}

void add_errors(std::vector<float>& errors, const Raster& raster, RefineReport& report) {
  if (errors.empty()) return;
  const double px = 1 / pixel_size(raster);
  double sum = 0;
  for (const float error : errors) sum += error;
  const auto p99 = errors.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(errors.size() - 1));
  std::nth_element(errors.begin(), p99, errors.end());
  report.error_px_p99 = std::max(report.error_px_p99, *p99 * px);
  report.error_px_mean = std::max(report.error_px_mean, sum / static_cast<double>(errors.size()) * px);
  report.error_px_max = std::max(report.error_px_max, *std::max_element(errors.begin(), errors.end()) * px);
}

Camera picture_camera(const Raster& raster, Projection projection, double smallest_depth, double largest_depth) {
  Camera camera;
  camera.name = "domewarp";
  camera.perspective = projection == Projection::perspective;
  camera.yfov = std::numbers::pi / 2;
  camera.aspect = aspect(raster);
  camera.xmag = aspect(raster);
  camera.ymag = 1;
  // Tight, with room for the rounding of a float32 file and a float32 depth buffer.
  camera.znear = smallest_depth > 0 ? smallest_depth * 0.99 : 0.01;
  camera.zfar = largest_depth > 0 ? largest_depth * 1.01 : 1.0;
  return camera;
}

} // namespace domewarp
