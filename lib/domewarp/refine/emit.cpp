// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/emit.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numbers>
#include <numeric>

#include "domewarp/core/parallel.h"
#include "domewarp/refine/hidden_faces.h"
#include "domewarp/refine/part_emitter.h"
#include "domewarp/refine/picture_rectangle.h"

namespace domewarp {

namespace {

constexpr std::size_t grain = 4096;
constexpr DrawnFace no_face = 0xffffffff;

/// The faces to draw in the order of the source, and where those of each part begin.
struct DrawnFaces {
  RawVector<DrawnFace> faces;
  std::vector<std::size_t> begin;
};

/// Sorted by counting: what comes from one face of the soup stays in the order of refinement.
DrawnFaces list_faces(const Soup& soup, const RefinedMesh& refined) {
  std::vector<std::uint32_t> next(soup.faces.size() + 1, 0);
  for (const RefinedFace& face : refined.faces) ++next[face.source + 1];
  for (const WholeFace& face : refined.whole) ++next[face.source + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  DrawnFaces drawn;
  drawn.begin.assign(soup.parts.size() + 1, next.back());
  for (std::size_t f = soup.faces.size(); f-- > 0;) drawn.begin[soup.faces[f].part] = next[f];
  for (std::size_t part = soup.parts.size(); part-- > 0;) drawn.begin[part] = std::min(drawn.begin[part], drawn.begin[part + 1]);
  drawn.faces.resize(next.back());
  for (std::uint32_t f = 0; f < refined.faces.size(); ++f) drawn.faces[next[refined.faces[f].source]++] = f;
  for (const WholeFace& face : refined.whole) drawn.faces[next[face.source]++] = face.source | whole_bit;
  return drawn;
}

/// Tells which faces need not be written.
class FaceDropper {
public:
  FaceDropper(const Soup& soup, const RefinedMesh& refined, const Raster& raster, const RefineOptions& options)
      : soup_(soup), refined_(refined), options_(options), half_extent_(kept_half_extent(options, raster)) {}

  void run(DrawnFaces& drawn, SkipReport& skipped) const {
    std::atomic<std::size_t> off_picture = 0, hidden = 0, zero_area = 0;
    parallel_each(drawn.faces.size(), grain, [&](std::size_t i) {
      std::atomic<std::size_t>* reason = nullptr;
      const Triangle point = corners_of(soup_, refined_, drawn.faces[i]).point;
      const std::array<const MappedPoint*, 3> corner{&refined_.points[point[0]], &refined_.points[point[1]], &refined_.points[point[2]]};
      if (is_off_picture(corner)) reason = &off_picture;
      else if (options_.is_hidden && is_hidden(corner, options_)) reason = &hidden;
      else if (has_equal_corners(corner)) reason = &zero_area;
      if (reason == nullptr) return;
      reason->fetch_add(1, std::memory_order_relaxed);
      drawn.faces[i] = no_face;
    });
    skipped.off_picture += off_picture;
    skipped.hidden += hidden;
    skipped.zero_area += zero_area;
    if (off_picture + hidden + zero_area > 0) compact(drawn);
  }

private:
  bool is_off_picture(const std::array<const MappedPoint*, 3>& corner) const {
    return options_.skip.off_picture && is_beyond(std::array{corner[0]->mapped.image, corner[1]->mapped.image, corner[2]->mapped.image}, half_extent_);
  }

  bool has_equal_corners(const std::array<const MappedPoint*, 3>& corner) const {
    if (!options_.skip.zero_area) return false;
    const auto position = [&](int k) { return warped_position(*corner[k], options_.projection); };
    const Vec3f a = position(0), b = position(1), c = position(2);
    return a == b || b == c || c == a;
  }

  static void compact(DrawnFaces& drawn) {
    std::size_t next = 0, begin = 0;
    for (std::size_t part = 0; part + 1 < drawn.begin.size(); ++part) {
      const std::size_t end = drawn.begin[part + 1];
      drawn.begin[part] = next;
      for (std::size_t i = begin; i < end; ++i)
        if (drawn.faces[i] != no_face) drawn.faces[next++] = drawn.faces[i];
      begin = end;
    }
    drawn.begin.back() = next;
    drawn.faces.resize(next);
  }

  const Soup& soup_;
  const RefinedMesh& refined_;
  const RefineOptions& options_;
  Vec2 half_extent_;
};

std::vector<std::uint8_t> drawn_wedges(const Soup& soup, const RefinedMesh& refined, const DrawnFaces& drawn) {
  std::vector<std::uint8_t> is_drawn(soup.wedge_point.size() + refined.wedges.size(), 0);
  parallel_each(drawn.faces.size(), grain, [&](std::size_t i) {
    for (const std::uint32_t wedge : corners_of(soup, refined, drawn.faces[i]).wedge) std::atomic_ref(is_drawn[wedge]).store(1, std::memory_order_relaxed);
  });
  return is_drawn;
}

} // namespace

void emit(const Scene& scene, const View& view, const Soup& soup, const RefinedMesh& refined, int orientation,
          const Raster& raster, const RefineOptions& options, Scene& out, RefineReport& report) {
  DrawnFaces drawn = list_faces(soup, refined);
  FaceDropper(soup, refined, raster, options).run(drawn, report.skipped);
  const std::vector<std::uint8_t> wedges = drawn_wedges(soup, refined, drawn);
  const WedgeValues values(scene, soup, refined, wedges, options);
  std::vector<std::uint32_t> vertex_of(wedges.size(), no_face);
  const EmitJob job{scene, view, soup, refined, options, values, wedges, orientation, vertex_of};
  std::vector<PartOutput> outputs(soup.parts.size());
  parallel_each(outputs.size(), 1, [&](std::size_t part) {
    const std::span<const DrawnFace> faces = std::span(drawn.faces).subspan(drawn.begin[part], drawn.begin[part + 1] - drawn.begin[part]);
    if (!faces.empty()) outputs[part] = emit_part(job, static_cast<std::uint32_t>(part), faces);
  });
  for (std::uint32_t part = 0; part < outputs.size(); ++part) {
    PartOutput& output = outputs[part];
    if (output.primitive.indices.empty()) continue;
    count_attributes(values.primitive(part), values.written(part), report.skipped);
    report.triangles_out += output.primitive.indices.size() / 3;
    report.vertices += output.primitive.positions.size();
    report.smallest_depth = report.smallest_depth > 0 ? std::min(report.smallest_depth, output.smallest_depth) : output.smallest_depth;
    report.largest_depth = std::max(report.largest_depth, output.largest_depth);
    out.meshes[soup.parts[part].instance].primitives.push_back(std::move(output.primitive));
  }
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
