// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/part_emitter.h"

#include <algorithm>
#include <mutex>
#include <numeric>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

constexpr std::uint32_t no_vertex = 0xffffffff;
constexpr std::size_t grain = 4096;

/// First the triangles and which vertices they need, then the vertices.
class PartEmitter {
public:
  PartEmitter(const EmitJob& job, std::uint32_t part)
      : job_(job), part_(part), source_(job.values.primitive(part)), writer_(job.view, job.scene.instances[job.soup.parts[part].instance].world),
        has_normals_(find_attribute(source_, "NORMAL") != nullptr) {}

  PartOutput emit(std::span<const DrawnFace> faces) {
    PartOutput out;
    out.primitive.material = source_.material;
    out.primitive.extras = source_.extras;
    out.primitive.indices.resize(3 * faces.size());
    out.primitive.keeps_order = !job_.options.vertex_colour && job_.values.derived_of(part_).empty();
    if (job_.options.vertex_colour)
      number_by_colour(faces, out.primitive.indices);
    else
      number(faces, out.primitive.indices);
    fill_positions(out);
    fill_attributes(out.primitive);
    if (job_.options.vertex_colour) fill_colours(out.primitive);
    return out;
  }

private:
  int corner(int k) const { return job_.orientation < 0 ? 2 - k : k; }

  /// One vertex per wedge that is drawn.
  void number(std::span<const DrawnFace> faces, std::vector<std::uint32_t>& indices) {
    const std::size_t first = job_.soup.parts[part_].first_wedge, count = source_vertices();
    std::vector<std::size_t> before((count + grain - 1) / grain + 1, 0);
    const auto each_drawn = [&](auto&& body) {
      parallel_each(before.size() - 1, 1, [&](std::size_t block) {
        for (std::size_t i = block * grain; i < std::min(count, (block + 1) * grain); ++i)
          if (job_.drawn[first + i]) body(block, static_cast<std::uint32_t>(first + i));
      });
    };
    each_drawn([&](std::size_t block, std::uint32_t) { ++before[block + 1]; });
    std::partial_sum(before.begin(), before.end(), before.begin());
    const std::vector<std::uint32_t>& derived = job_.values.derived_of(part_);
    const std::size_t own = before.back();
    wedge_.resize(own + derived.size());
    const auto add = [&](std::size_t vertex, std::uint32_t wedge) {
      wedge_[vertex] = wedge;
      job_.vertex_of[wedge] = static_cast<std::uint32_t>(vertex);
    };
    each_drawn([&](std::size_t block, std::uint32_t wedge) { add(before[block]++, wedge); });
    parallel_each(derived.size(), grain, [&](std::size_t i) { add(own + i, derived[i]); });
    parallel_each(faces.size(), grain, [&](std::size_t f) {
      const Triangle& wedge = corners_of(job_.soup, job_.refined, faces[f]).wedge;
      for (int k = 0; k < 3; ++k) indices[3 * f + k] = job_.vertex_of[wedge[corner(k)]];
    });
  }

  /// One vertex per wedge and colour, in the order of first use.
  void number_by_colour(std::span<const DrawnFace> faces, std::vector<std::uint32_t>& indices) {
    std::vector<std::uint32_t> next; // vertex of the same wedge with another colour
    const auto vertex = [&](std::uint32_t wedge, std::uint32_t face) {
      for (std::uint32_t v = job_.vertex_of[wedge]; v != no_vertex; v = next[v])
        if (look_alike(face_[v], face)) return v;
      wedge_.push_back(wedge);
      face_.push_back(face);
      next.push_back(job_.vertex_of[wedge]);
      return job_.vertex_of[wedge] = static_cast<std::uint32_t>(wedge_.size() - 1);
    };
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const DrawnCorners face = corners_of(job_.soup, job_.refined, faces[f]);
      for (int k = 0; k < 3; ++k) indices[3 * f + k] = vertex(face.wedge[corner(k)], face.source);
    }
  }

  /// Whether a vertex can have one colour for both faces: without normals of their own only if it is one face, else if
  /// the same side is seen of both.
  bool look_alike(std::uint32_t f, std::uint32_t g) const {
    return f == g || (has_normals_ && is_seen_from_behind(f) == is_seen_from_behind(g));
  }

  std::size_t source_vertices() const {
    const std::vector<SoupPart>& parts = job_.soup.parts;
    return (part_ + 1 < parts.size() ? parts[part_ + 1].first_wedge : job_.soup.source_wedges) - parts[part_].first_wedge;
  }

  std::array<Vec3, 3> corners_of_source(std::uint32_t f) const {
    const Triangle point = points_of(job_.soup, job_.soup.faces[f]);
    return {job_.refined.points[point[0]].eye, job_.refined.points[point[1]].eye, job_.refined.points[point[2]].eye};
  }

  static Vec3 normal_of(const std::array<Vec3, 3>& p) { return glm::cross(p[1] - p[0], p[2] - p[0]); }

  bool is_seen_from_behind(std::uint32_t f) const {
    const std::array<Vec3, 3> corner = corners_of_source(f);
    return glm::dot(normal_of(corner), corner[0]) > 0;
  }

  const MappedPoint& point(std::size_t vertex) const { return job_.refined.points[job_.values.point_of(wedge_[vertex])]; }

  void fill_positions(PartOutput& out) const {
    std::vector<Vec3f>& positions = out.primitive.positions;
    positions.resize(wedge_.size());
    std::mutex guard;
    parallel_ranges(positions.size(), grain, [&](std::size_t begin, std::size_t end) {
      double smallest = std::numeric_limits<double>::infinity(), largest = 0;
      for (std::size_t i = begin; i < end; ++i) {
        positions[i] = warped_position(point(i), job_.options.projection);
        smallest = std::min(smallest, static_cast<double>(-positions[i].z));
        largest = std::max(largest, static_cast<double>(-positions[i].z));
      }
      const std::lock_guard lock(guard);
      out.smallest_depth = std::min(out.smallest_depth, smallest);
      out.largest_depth = std::max(out.largest_depth, largest);
    });
  }

  void fill_attributes(Primitive& out) const {
    int first = 0;
    for (const Attribute* attribute : job_.values.written(part_)) {
      const int components = attribute->components;
      out.attributes.push_back({attribute->name, components, std::vector<float>(wedge_.size() * components)});
      fill(*attribute, first, out.attributes.back().values);
      first += components;
    }
    if (!job_.options.source_attributes) return;
    std::vector<float>& source = out.attributes.emplace_back(source_position, 3, std::vector<float>(3 * wedge_.size())).values;
    parallel_each(wedge_.size(), grain, [&](std::size_t i) {
      for (int c = 0; c < 3; ++c) source[3 * i + c] = static_cast<float>(point(i).eye[c]);
    });
  }

  /// @param first of the attribute's components among all that are written
  void fill(const Attribute& attribute, int first, std::vector<float>& out) const {
    const std::size_t components = attribute.components, first_wedge = job_.soup.parts[part_].first_wedge;
    const bool turns = AttributeWriter::turns(attribute);
    parallel_ranges(wedge_.size(), grain, [&](std::size_t begin, std::size_t end) {
      std::vector<double> values(components);
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t wedge = wedge_[i];
        if (job_.values.is_derived(wedge)) {
          writer_.write(attribute, job_.values.derived(wedge, first), &out[i * components]);
          continue;
        }
        const float* given = &attribute.values[(wedge - first_wedge) * components];
        if (!turns) {
          std::copy_n(given, components, &out[i * components]);
          continue;
        }
        std::copy_n(given, components, values.begin());
        writer_.write(attribute, values.data(), &out[i * components]);
      }
    });
  }

  /// Replaces COLOR_0 by what the caller makes of it.
  void fill_colours(Primitive& out) const {
    const Attribute* given = find_attribute(out, "COLOR_0");
    const Attribute* normals = find_attribute(out, "NORMAL");
    const int components = given != nullptr && given->components == 4 ? 4 : 3;
    std::vector<float> colours(wedge_.size() * components);
    parallel_each(wedge_.size(), 64, [&](std::size_t i) {
      const std::array<Vec3, 3> corner = corners_of_source(face_[i]);
      VertexToColour vertex;
      vertex.instance = job_.soup.parts[part_].instance;
      vertex.primitive = job_.soup.parts[part_].primitive;
      vertex.eye = point(i).eye;
      vertex.face_normal = normal_of(corner);
      vertex.face_centre = (corner[0] + corner[1] + corner[2]) / 3.0;
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
  std::vector<std::uint32_t> wedge_; ///< per vertex
  std::vector<std::uint32_t> face_;  ///< per vertex, of the soup, the first that uses it; only where vertices are coloured
};

} // namespace

PartOutput emit_part(const EmitJob& job, std::uint32_t part, std::span<const DrawnFace> faces) { return PartEmitter(job, part).emit(faces); }

} // namespace domewarp
