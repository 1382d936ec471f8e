// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/emit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/t_junctions.h"
#include "domewarp/refine/warped_vertex.h"

namespace domewarp {

namespace {

constexpr std::uint32_t unused = 0xffffffff;

/// Attribute values of the derived wedges that the output needs, in the space of their mesh, components of all
/// attributes of the part side by side. A wedge's parents come before it, so one ascending pass is enough.
class WedgeValues {
public:
  WedgeValues(const Scene& scene, const Soup& soup, const RefinedMesh& refined, const std::vector<std::uint8_t>& drawn)
      : scene_(scene), soup_(soup), refined_(refined), first_derived_(static_cast<std::uint32_t>(soup.wedge_point.size())) {
    const std::uint32_t count = static_cast<std::uint32_t>(soup.extra_wedges.size() + refined.wedges.size());
    std::vector<std::uint8_t> needed(drawn.begin() + first_derived_, drawn.end());
    for (std::uint32_t i = count; i-- > 0;)
      if (needed[i])
        for (const std::uint32_t parent : derived(first_derived_ + i).parent)
          if (parent >= first_derived_) needed[parent - first_derived_] = 1;
    for (const SoupPart& part : soup.parts) {
      int stride = 0;
      for (const Attribute& attribute : primitive(part).attributes) stride += attribute.components;
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
    for (const Attribute& attribute : primitive(soup_.parts[part]).attributes)
      for (int c = 0; c < attribute.components; ++c) *out++ = attribute.values[vertex * attribute.components + c];
  }

  int stride(std::uint32_t part) const { return stride_[part]; }

  const Primitive& primitive(const SoupPart& part) const {
    return scene_.meshes[scene_.instances[part.instance].mesh].primitives[part.primitive];
  }

private:
  const Wedge& derived(std::uint32_t wedge) const {
    const std::uint32_t i = wedge - first_derived_;
    return i < soup_.extra_wedges.size() ? soup_.extra_wedges[i] : refined_.wedges[i - soup_.extra_wedges.size()];
  }

  void blend(std::uint32_t id, double* out) const {
    const Wedge& wedge = derived(id);
    const int stride = stride_[wedge.part];
    std::vector<double> parent(stride);
    std::fill_n(out, stride, 0.0);
    for (int k = 0; k < 3; ++k) {
      if (wedge.weight[k] == 0) continue;
      get(wedge.parent[k], wedge.part, parent.data());
      for (int c = 0; c < stride; ++c) out[c] += wedge.weight[k] * parent[c];
    }
  }

  const Scene& scene_;
  const Soup& soup_;
  const RefinedMesh& refined_;
  std::uint32_t first_derived_;
  std::vector<int> stride_;          ///< per part
  std::vector<std::size_t> offset_;  ///< per derived wedge
  std::vector<double> values_;
};

bool is_off_picture(const RefinedMesh& refined, const RefinedFace& face, const Vec2& half_extent) {
  const auto image = [&](int k) { return refined.points[face.point[k]].mapped.image; };
  const Vec2 a = image(0), b = image(1), c = image(2);
  for (int axis = 0; axis < 2; ++axis)
    if (std::min({a[axis], b[axis], c[axis]}) > half_extent[axis] || std::max({a[axis], b[axis], c[axis]}) < -half_extent[axis])
      return true;
  return false;
}

struct PartOutput {
  Primitive primitive;
  std::size_t zero_area = 0;
  double smallest_depth = std::numeric_limits<double>::infinity(), largest_depth = 0;
};

class PartEmitter {
public:
  PartEmitter(const View& view, const Soup& soup, const RefinedMesh& refined, const WedgeValues& values, const Scene& scene,
              const RefineOptions& options, std::vector<std::uint32_t>& vertex_of)
      : soup_(soup), refined_(refined), values_(values), options_(options), part_(0), vertex_of_(vertex_of),
        writer_(view, scene.instances.front().world), view_(view), scene_(scene) {}

  /// @param faces indices into refined.faces, all of `part`
  PartOutput emit(std::uint32_t part, std::span<const std::uint32_t> faces, int orientation) {
    part_ = part;
    const Primitive& source = values_.primitive(soup_.parts[part]);
    writer_ = AttributeWriter(view_, scene_.instances[soup_.parts[part].instance].world);
    PartOutput out;
    out.primitive.material = source.material;
    for (const Attribute& attribute : source.attributes)
      if (attribute.name != source_position) out.primitive.attributes.push_back({attribute.name, attribute.components, {}});
    if (options_.source_attributes) out.primitive.attributes.push_back({source_position, 3, {}});
    scratch_.resize(values_.stride(part));
    for (const std::uint32_t f : faces) {
      const RefinedFace& face = refined_.faces[f];
      if (options_.skip.zero_area && has_equal_corners(face)) {
        ++out.zero_area;
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        const int corner = orientation < 0 ? 2 - k : k;
        out.primitive.indices.push_back(vertex(face.wedge[corner], face.point[corner], source, out));
      }
    }
    return out;
  }

private:
  bool has_equal_corners(const RefinedFace& face) const {
    const auto position = [&](int k) { return warped_position(refined_.points[face.point[k]], options_.projection); };
    const Vec3f a = position(0), b = position(1), c = position(2);
    return a == b || b == c || c == a;
  }

  std::uint32_t vertex(std::uint32_t wedge, std::uint32_t point, const Primitive& source, PartOutput& out) {
    std::uint32_t& id = vertex_of_[wedge];
    if (id != unused) return id;
    id = static_cast<std::uint32_t>(out.primitive.positions.size());
    const MappedPoint& mapped = refined_.points[point];
    const Vec3f position = warped_position(mapped, options_.projection);
    out.smallest_depth = std::min(out.smallest_depth, static_cast<double>(-position.z));
    out.largest_depth = std::max(out.largest_depth, static_cast<double>(-position.z));
    out.primitive.positions.push_back(position);
    values_.get(wedge, part_, scratch_.data());
    const double* values = scratch_.data();
    std::size_t written = 0;
    for (const Attribute& attribute : source.attributes) {
      if (attribute.name != source_position) writer_.append(attribute, values, out.primitive.attributes[written++].values);
      values += attribute.components;
    }
    if (options_.source_attributes) {
      const Vec3f eye(mapped.eye);
      out.primitive.attributes.back().values.insert(out.primitive.attributes.back().values.end(), {eye.x, eye.y, eye.z});
    }
    return id;
  }

  const Soup& soup_;
  const RefinedMesh& refined_;
  const WedgeValues& values_;
  const RefineOptions& options_;
  std::uint32_t part_;
  std::vector<std::uint32_t>& vertex_of_;
  AttributeWriter writer_;
  const View& view_;
  const Scene& scene_;
  std::vector<double> scratch_;
};

} // namespace

double picture_margin(const RefineOptions& options, const Raster& raster) { return (options.tolerance_px + 1) * pixel_size(raster); }

void emit(const Scene& scene, const View& view, const Soup& soup, const RefinedMesh& refined, int orientation,
          const Raster& raster, const RefineOptions& options, Scene& out, RefineReport& report) {
  const double margin = picture_margin(options, raster);
  const Vec2 half_extent(aspect(raster) + margin, 1 + margin);
  std::vector<std::vector<std::uint32_t>> faces_of(soup.parts.size());
  std::vector<std::uint8_t> drawn(soup.wedge_point.size() + soup.extra_wedges.size() + refined.wedges.size(), 0);
  for (std::uint32_t f = 0; f < refined.faces.size(); ++f) {
    const RefinedFace& face = refined.faces[f];
    if (is_off_picture(refined, face, half_extent)) {
      ++report.skipped.off_picture;
      continue;
    }
    faces_of[soup.faces[face.source].part].push_back(f);
    for (const std::uint32_t wedge : face.wedge) drawn[wedge] = 1;
  }
  const WedgeValues values(scene, soup, refined, drawn);
  std::vector<std::uint32_t> vertex_of(drawn.size(), unused);
  std::vector<PartOutput> outputs(soup.parts.size());
  parallel_each(outputs.size(), 1, [&](std::size_t part) {
    if (faces_of[part].empty()) return;
    PartEmitter emitter(view, soup, refined, values, scene, options, vertex_of);
    outputs[part] = emitter.emit(static_cast<std::uint32_t>(part), faces_of[part], orientation);
  });
  for (std::size_t part = 0; part < outputs.size(); ++part) {
    PartOutput& output = outputs[part];
    report.skipped.zero_area += output.zero_area;
    if (output.primitive.indices.empty()) continue;
    report.triangles_out += output.primitive.indices.size() / 3;
    report.vertices += output.primitive.positions.size();
    report.smallest_depth = report.smallest_depth > 0 ? std::min(report.smallest_depth, output.smallest_depth) : output.smallest_depth;
    report.largest_depth = std::max(report.largest_depth, output.largest_depth);
    out.meshes[soup.parts[part].instance].primitives.push_back(std::move(output.primitive));
  }
}

void audit_edges(const Soup& soup, const RefinedMesh& refined, const EdgeOracle& oracle, const Raster& raster,
                 RefineReport& report) {
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
  std::vector<float> errors;
  MeshTopology open;
  for (std::size_t e = 0; e < faces.size(); ++e) {
    if (faces[e] == 0) continue;
    const RefinedEdge& edge = refined.edges[e];
    errors.push_back(edge.error);
    report.depth_error_max = std::max(report.depth_error_max, static_cast<double>(edge.depth_error));
    report.uncertified_edges += !edge.certified || edge.error * (1 - 1e-6f) > tolerance;
    if (faces[e] != 1 || is_rim(edge)) continue;
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
