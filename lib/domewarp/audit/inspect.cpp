// SPDX-License-Identifier: GPL-3.0-or-later
#include "domewarp/audit/inspect.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <sstream>
#include <tuple>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "domewarp/audit/hanging.h"
#include "domewarp/scene/view.h"

namespace domewarp {

namespace {

using Corners = std::array<std::uint32_t, 3>;
using Edge = std::array<std::uint32_t, 2>;

/// All drawn triangles, corner by corner.
struct Drawn {
  std::vector<Vec3> position; ///< world space, one per drawn vertex
  std::vector<Vec3> source;   ///< _SOURCE_POSITION, one per drawn vertex, or empty
  std::vector<Corners> triangles;
};

Drawn collect(const Scene& scene) {
  Drawn drawn;
  bool all_have_source = true;
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives) {
      if (primitive.topology != Topology::triangles) continue;
      const Attribute* source = find_attribute(primitive, "_SOURCE_POSITION");
      all_have_source = all_have_source && source != nullptr && source->components == 3;
      const std::uint32_t first = static_cast<std::uint32_t>(drawn.position.size());
      for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
        drawn.position.push_back(to_world(instance.world, primitive.positions[v]) + Vec3(0.0));
        if (all_have_source) drawn.source.push_back(Vec3(source->values[3 * v], source->values[3 * v + 1], source->values[3 * v + 2]) + Vec3(0.0));
      }
      for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3)
        drawn.triangles.push_back({first + primitive.indices[i], first + primitive.indices[i + 1], first + primitive.indices[i + 2]});
    }
  if (!all_have_source) drawn.source.clear();
  return drawn;
}

std::tuple<double, double, double> key(const Vec3& p) { return {p.x, p.y, p.z}; }

/// For every position the index of the first equal one, found by sorting; `distinct` counts them.
std::vector<std::uint32_t> first_equal(const std::vector<Vec3>& positions, std::size_t& distinct) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(key(positions[a]), a) < std::tuple(key(positions[b]), b);
  });
  distinct = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_new = i == 0 || key(positions[order[i]]) != key(positions[order[i - 1]]);
    distinct += is_new;
    first[order[i]] = is_new ? order[i] : first[order[i - 1]];
  }
  return first;
}

/// Edges of the welded triangles with the number of triangles on each.
struct EdgeUse {
  std::vector<Edge> open;
  std::size_t non_manifold = 0;
};

EdgeUse use_edges(const std::vector<Corners>& triangles) {
  std::vector<Edge> edges;
  for (const Corners& t : triangles)
    for (int k = 0; k < 3; ++k) edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  std::sort(edges.begin(), edges.end());
  EdgeUse use;
  for (auto it = edges.begin(); it != edges.end();) {
    const auto end = std::find_if(it, edges.end(), [&](const Edge& e) { return e != *it; });
    if (end - it == 1) use.open.push_back(*it);
    use.non_manifold += end - it > 2;
    it = end;
  }
  return use;
}

std::vector<std::uint32_t> ends(const std::vector<Edge>& edges) {
  std::vector<std::uint32_t> ids;
  for (const Edge& edge : edges) ids.insert(ids.end(), edge.begin(), edge.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

double diagonal(const std::vector<Vec3>& positions) {
  if (positions.empty()) return 0;
  Vec3 low = positions[0], high = low;
  for (const Vec3& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return glm::length(high - low);
}

/// Welds, counts and removes triangles without area.
std::vector<Corners> proper_triangles(const Drawn& drawn, const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& first,
                                      std::size_t& degenerate) {
  std::vector<Corners> proper;
  for (const Corners& t : drawn.triangles) {
    const Corners welded{first[t[0]], first[t[1]], first[t[2]]};
    const bool equal = welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0];
    const bool flat = !equal && are_collinear(positions[welded[0]], positions[welded[1]], positions[welded[2]]);
    degenerate += equal || flat;
    if (!equal) proper.push_back(welded); // a flat one still fills its neighbours' edges
  }
  return proper;
}

std::size_t count_duplicates(std::vector<Corners> triangles) {
  for (Corners& t : triangles) std::sort(t.begin(), t.end());
  std::sort(triangles.begin(), triangles.end());
  const auto unique_end = std::unique(triangles.begin(), triangles.end());
  return static_cast<std::size_t>(triangles.end() - unique_end);
}

/// Where a warped vertex appears, in pixels: through a perspective camera of 90 degrees, or straight down.
Vec2 picture(const Vec3& position, bool perspective, int height) {
  return Vec2(position) / (perspective ? -position.z : 1.0) * (0.5 * height);
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double length2 = glm::dot(d, d);
  const double t = length2 > 0 ? glm::clamp(glm::dot(p - a, d) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - (a + t * d));
}

CrackReport find_cracks(const Drawn& drawn, bool perspective, int height) {
  CrackReport report;
  std::size_t distinct = 0, degenerate = 0;
  const std::vector<std::uint32_t> first = first_equal(drawn.source, distinct);
  std::vector<std::uint8_t> torn(first.size(), 0);
  const auto at = [&](std::uint32_t vertex) { return picture(drawn.position[vertex], perspective, height); };
  for (std::uint32_t v = 0; v < first.size(); ++v) {
    if (drawn.position[v] == drawn.position[first[v]]) continue;
    torn[first[v]] = 1;
    report.max_gap_px = std::max(report.max_gap_px, glm::length(at(v) - at(first[v])));
  }
  report.torn_positions = static_cast<std::size_t>(std::count(torn.begin(), torn.end(), 1));
  const EdgeUse use = use_edges(proper_triangles(drawn, drawn.source, first, degenerate));
  report.open_edges = use.open.size();
  const std::vector<std::uint32_t> vertices = ends(use.open);
  const double tolerance = 1e-6 * diagonal(drawn.source);
  for (const HangingVertex& hanging : find_hanging_vertices(drawn.source, use.open, vertices, tolerance)) {
    ++report.t_junctions;
    const Edge& edge = use.open[hanging.edge];
    report.max_gap_px = std::max(report.max_gap_px, distance_to_segment(at(vertices[hanging.vertex]), at(edge[0]), at(edge[1])));
  }
  return report;
}

} // namespace

InspectReport inspect(const Scene& scene, int height) {
  InspectReport report;
  report.meshes = scene.meshes.size();
  report.instances = scene.instances.size();
  for (const Mesh& mesh : scene.meshes) report.primitives += mesh.primitives.size();
  report.materials = scene.materials.size();
  const Drawn drawn = collect(scene);
  report.triangles = drawn.triangles.size();
  report.vertices = drawn.position.size();
  const std::vector<std::uint32_t> first = first_equal(drawn.position, report.unique_positions);
  const std::vector<Corners> triangles = proper_triangles(drawn, drawn.position, first, report.degenerate);
  report.duplicate = count_duplicates(triangles);
  const EdgeUse use = use_edges(triangles);
  report.open_edges = use.open.size();
  report.non_manifold_edges = use.non_manifold;
  const std::vector<std::uint32_t> vertices = ends(use.open);
  for (const HangingVertex& hanging : find_hanging_vertices(drawn.position, use.open, vertices, 1e-5 * diagonal(drawn.position))) {
    ++report.t_junctions;
    const Vec3 a = drawn.position[use.open[hanging.edge][0]], b = drawn.position[use.open[hanging.edge][1]];
    report.max_gap = std::max(report.max_gap, glm::length(drawn.position[vertices[hanging.vertex]] - (a + hanging.t * (b - a))));
  }
  const bool perspective = scene.cameras.empty() || scene.cameras.front().perspective;
  if (!drawn.source.empty()) report.cracks = find_cracks(drawn, perspective, height);
  return report;
}

std::string to_json(const InspectReport& report) {
  nlohmann::ordered_json json = {{"triangles", report.triangles},
                                 {"vertices", report.vertices},
                                 {"unique_positions", report.unique_positions},
                                 {"open_edges", report.open_edges},
                                 {"non_manifold_edges", report.non_manifold_edges},
                                 {"t_junctions", report.t_junctions},
                                 {"degenerate", report.degenerate},
                                 {"duplicate", report.duplicate},
                                 {"max_gap", report.max_gap},
                                 {"meshes", report.meshes},
                                 {"instances", report.instances},
                                 {"primitives", report.primitives},
                                 {"materials", report.materials}};
  if (report.cracks)
    json["cracks"] = {{"torn_positions", report.cracks->torn_positions},
                      {"open_edges", report.cracks->open_edges},
                      {"t_junctions_out", report.cracks->t_junctions},
                      {"max_gap_px", report.cracks->max_gap_px}};
  return json.dump(2) + "\n";
}

std::string to_text(const InspectReport& report) {
  std::ostringstream text;
  const auto row = [&](const char* name, auto value, const char* note = "") {
    text << name << std::string(22 - std::string(name).size(), ' ') << value << note << "\n";
  };
  row("instances", report.instances);
  row("meshes", report.meshes);
  row("primitives", report.primitives);
  row("materials", report.materials);
  row("triangles", report.triangles);
  row("vertices", report.vertices);
  row("unique positions", report.unique_positions);
  row("open edges", report.open_edges);
  row("non-manifold edges", report.non_manifold_edges);
  row("degenerate triangles", report.degenerate);
  row("duplicate triangles", report.duplicate);
  row("T-junctions", report.t_junctions);
  if (report.t_junctions > 0) row("largest gap at one", report.max_gap, " scene units");
  if (!report.cracks) return text.str();
  text << "\nin source space (_SOURCE_POSITION)\n";
  row("torn positions", report.cracks->torn_positions);
  row("open edges", report.cracks->open_edges, " (rim and culled neighbours included)");
  row("T-junctions", report.cracks->t_junctions);
  row("largest gap", report.cracks->max_gap_px, " px");
  return text.str();
}

} // namespace domewarp
