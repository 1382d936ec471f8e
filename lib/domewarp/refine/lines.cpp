// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/lines.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/mesh/weld.h"
#include "domewarp/refine/emit.h"
#include "domewarp/refine/picture_rectangle.h"
#include "domewarp/refine/warped_vertex.h"

namespace domewarp {

namespace {

constexpr std::uint32_t unused = 0xffffffff;
constexpr int deepest_level = 200; ///< as for triangles
constexpr std::size_t block_size = 1024;

/// Eye space, with -0 as +0: the positions that triangles have after welding.
Vec3 eye_position(const View& view, const Mat4& world, const Vec3f& position) {
  return to_eye(view, to_world(world, position)) + 0.0;
}

bool is_visible(const MappedPoint& point) { return *std::min_element(point.sides.begin(), point.sides.end()) >= 0; }

/// One end of a piece of a segment, t from the segment's first end.
struct Station {
  MappedPoint point;
  double t = 0;
  std::uint32_t source = unused; ///< vertex of the source, if it is one
};

struct Piece {
  Station from, to;
  EdgeDecision decision;
};

/// A segment in pieces, in its own direction.
struct RefinedSegment {
  std::vector<Piece> pieces;
  std::size_t evaluations = 0;
  bool stopped = false;
};

class SegmentRefiner {
public:
  SegmentRefiner(const EdgeOracle& oracle, const Station& a, const Station& b, std::size_t most_pieces)
      : oracle_(oracle), a_(a.point.eye), d_(b.point.eye - a.point.eye), most_pieces_(most_pieces) {
    refine(a, b, 0);
  }

  RefinedSegment take() { return std::move(result_); }

private:
  void refine(const Station& from, const Station& to, int level) {
    const bool in_order = precedes(from.point.eye, to.point.eye);
    EdgeDecision decision = in_order ? oracle_.decide(from.point, to.point) : oracle_.decide(to.point, from.point);
    result_.evaluations += decision.evaluations;
    if (decision.split && level < deepest_level && result_.pieces.size() < most_pieces_) {
      const Station middle{decision.split->point, glm::dot(decision.split->point.eye - a_, d_) / glm::dot(d_, d_)};
      refine(from, middle, level + 1);
      refine(middle, to, level + 1);
      return;
    }
    result_.stopped = result_.stopped || decision.split.has_value();
    if (is_visible(from.point) && is_visible(to.point)) result_.pieces.push_back({from, to, decision});
  }

  const EdgeOracle& oracle_;
  Vec3 a_, d_;
  std::size_t most_pieces_;
  RefinedSegment result_;
};

/// The ends of a segment of the source: vertices of its primitive.
struct Segment {
  std::uint32_t a = 0, b = 0;
};

/// Writes the warped form of one primitive of lines or points.
class LineEmitter {
public:
  LineEmitter(const Primitive& source, const View& view, const Mat4& world, const EdgeOracle& oracle, const Raster& raster,
              const RefineOptions& options, RefineReport& report)
      : source_(source), oracle_(oracle), options_(options), written_(written_attributes(source, options)), writer_(view, world),
        half_extent_(kept_half_extent(options, raster)), report_(report), vertices_(source.positions.size()),
        vertex_of_(source.positions.size(), unused) {
    parallel_each(vertices_.size(), block_size,
                  [&](std::size_t i) { vertices_[i] = oracle.locate(eye_position(view, world, source.positions[i])); });
    report.map_evaluations += vertices_.size();
    out_.topology = source.topology;
    out_.material = source.material;
    out_.extras = source.extras;
    for (const Attribute* attribute : written_) out_.attributes.push_back({attribute->name, attribute->components, {}});
    if (options.source_attributes) out_.attributes.push_back({source_position, 3, {}});
  }

  Primitive points() {
    for (const std::uint32_t index : source_.indices) {
      const MappedPoint& point = vertices_[index];
      if (is_visible(point) && !is_beyond(std::array{point.mapped.image}, half_extent_))
        out_.indices.push_back(vertex({index, index}, {point, 0, index}));
    }
    report_.points_out += out_.indices.size();
    return std::move(out_);
  }

  Primitive lines(std::vector<float>& errors) {
    const std::size_t segments = source_.indices.size() / 2;
    std::vector<RefinedSegment> refined(segments);
    parallel_each(segments, block_size, [&](std::size_t i) {
      const std::uint32_t a = source_.indices[2 * i], b = source_.indices[2 * i + 1];
      if (vertices_[a].eye == vertices_[b].eye) return;
      refined[i] = SegmentRefiner(oracle_, {vertices_[a], 0, a}, {vertices_[b], 1, b}, options_.max_triangles).take();
    });
    for (std::size_t i = 0; i < segments; ++i) {
      report_.map_evaluations += refined[i].evaluations;
      if (refined[i].stopped) report_.limits_hit.push_back("max-triangles");
      append({source_.indices[2 * i], source_.indices[2 * i + 1]}, refined[i].pieces, errors);
    }
    report_.lines_out += out_.indices.size() / 2;
    return std::move(out_);
  }

private:
  void append(const Segment& segment, const std::vector<Piece>& pieces, std::vector<float>& errors) {
    double last_t = -1;
    std::uint32_t last = unused;
    for (const Piece& piece : pieces) {
      if (is_beyond(std::array{piece.from.point.mapped.image, piece.to.point.mapped.image}, half_extent_)) continue;
      const std::uint32_t from = piece.from.t == last_t ? last : vertex(segment, piece.from);
      last = vertex(segment, piece.to);
      last_t = piece.to.t;
      out_.indices.insert(out_.indices.end(), {from, last});
      errors.push_back(piece.decision.error);
      report_.depth_error_max = std::max(report_.depth_error_max, static_cast<double>(piece.decision.depth_error));
      report_.uncertified_edges += piece.decision.error > oracle_.options().tolerance;
    }
  }

  /// The output's vertex for a station; ends of segments are shared as they are in the source.
  std::uint32_t vertex(const Segment& segment, const Station& station) {
    if (station.source == unused) return append_vertex(segment, station);
    std::uint32_t& known = vertex_of_[station.source];
    if (known == unused) known = append_vertex(segment, station);
    return known;
  }

  std::uint32_t append_vertex(const Segment& segment, const Station& station) {
    const Vec3f position = warped_position(station.point, options_.projection);
    const double depth = -static_cast<double>(position.z);
    report_.smallest_depth = report_.smallest_depth > 0 ? std::min(report_.smallest_depth, depth) : depth;
    report_.largest_depth = std::max(report_.largest_depth, depth);
    out_.positions.push_back(position);
    std::size_t written = 0;
    std::vector<double> values;
    for (const Attribute* attribute : written_) {
      values.resize(attribute->components);
      for (int c = 0; c < attribute->components; ++c) {
        const auto at = [&](std::uint32_t v) { return double(attribute->values[std::size_t(v) * attribute->components + c]); };
        values[c] = at(segment.a) * (1 - station.t) + at(segment.b) * station.t;
      }
      std::vector<float>& out = out_.attributes[written++].values;
      out.resize(out.size() + attribute->components);
      writer_.write(*attribute, values.data(), out.data() + out.size() - attribute->components);
    }
    if (options_.source_attributes) {
      const Vec3f eye(station.point.eye);
      out_.attributes.back().values.insert(out_.attributes.back().values.end(), {eye.x, eye.y, eye.z});
    }
    return static_cast<std::uint32_t>(out_.positions.size() - 1);
  }

  const Primitive& source_;
  const EdgeOracle& oracle_;
  const RefineOptions& options_;
  std::vector<const Attribute*> written_;
  AttributeWriter writer_;
  Vec2 half_extent_;
  RefineReport& report_;
  std::vector<MappedPoint> vertices_;
  std::vector<std::uint32_t> vertex_of_;
  Primitive out_;
};

/// Calls body(instance index, primitive) for every drawn primitive of lines or points.
template <typename Body>
void each_line_primitive(const Scene& scene, Body&& body) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i)
    for (const Primitive& primitive : scene.meshes[scene.instances[i].mesh].primitives)
      if (primitive.topology != Topology::triangles) body(i, primitive);
}

} // namespace

LineCounts count_lines(const Scene& scene, const View& view) {
  LineCounts counts;
  each_line_primitive(scene, [&](std::size_t i, const Primitive& primitive) {
    if (primitive.topology == Topology::lines)
      counts.lines += primitive.indices.size() / 2;
    else
      counts.points += primitive.indices.size();
    for (const std::uint32_t index : primitive.indices)
      counts.extent =
          std::max(counts.extent, glm::length(eye_position(view, scene.instances[i].world, primitive.positions[index])));
  });
  return counts;
}

void emit_lines(const Scene& scene, const View& view, const EdgeOracle& oracle, const Raster& raster,
                const RefineOptions& options, Scene& out, RefineReport& report) {
  std::vector<float> errors;
  each_line_primitive(scene, [&](std::size_t i, const Primitive& primitive) {
    LineEmitter emitter(primitive, view, scene.instances[i].world, oracle, raster, options, report);
    Primitive warped = primitive.topology == Topology::points ? emitter.points() : emitter.lines(errors);
    if (warped.indices.empty()) return;
    count_attributes(primitive, written_attributes(primitive, options), report.skipped);
    report.vertices += warped.positions.size();
    out.meshes[i].primitives.push_back(std::move(warped));
  });
  add_errors(errors, raster, report);
}

} // namespace domewarp
