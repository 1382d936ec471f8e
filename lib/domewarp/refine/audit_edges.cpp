// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>

#include "domewarp/core/parallel.h"
#include "domewarp/core/quantile.h"
#include "domewarp/mesh/t_junctions.h"
#include "domewarp/refine/emit.h"
#include "domewarp/refine/picture_rectangle.h"

namespace domewarp {

namespace {

constexpr std::size_t block_size = 8192;

/// What the edges of one block tell.
struct EdgeBlock {
  std::vector<float> errors;
  std::vector<MeshTopology::Edge> open;
  float slide = 0;
  double depth_error = 0, widest_gap = 0;
  std::size_t uncertified = 0, unexplained = 0;
};

class EdgeAudit {
public:
  EdgeAudit(const RefinedMesh& refined, const EdgeOracle& oracle, const Vec2& half_extent)
      : refined_(refined), oracle_(oracle), half_extent_(half_extent), faces_(refined.edges.size(), 0) {
    parallel_each(refined.faces.size(), block_size, [&](std::size_t f) {
      for (const std::uint32_t edge : refined.faces[f].edge) std::atomic_ref(faces_[edge]).fetch_add(1, std::memory_order_relaxed);
    });
  }

  std::vector<EdgeBlock> run() const {
    std::vector<EdgeBlock> blocks((faces_.size() + block_size - 1) / block_size);
    parallel_each(blocks.size(), 1, [&](std::size_t block) {
      for (std::size_t e = block * block_size; e < std::min(faces_.size(), (block + 1) * block_size); ++e)
        if (faces_[e] > 0) judge(refined_.edges[e], faces_[e], blocks[block]);
    });
    return blocks;
  }

private:
  void judge(const RefinedEdge& edge, std::uint32_t faces, EdgeBlock& block) const {
    if (edge.slides)
      block.slide = std::max(block.slide, edge.error);
    else
      block.errors.push_back(edge.error);
    block.depth_error = std::max(block.depth_error, static_cast<double>(edge.depth_error));
    block.uncertified += !edge.certified || (!edge.slides && edge.error * (1 - 1e-6f) > static_cast<float>(oracle_.options().tolerance));
    const SourceEdge source = edge.inner ? SourceEdge{2, 0} : refined_.source_edges[edge.source];
    if (is_whole_source_edge(refined_, edge)) faces += source.whole; // faces drawn as they are fit to it and to nothing smaller
    if (faces != 1 || is_rim(edge)) return;
    if (is_beyond(std::array{refined_.points[edge.a].mapped.image, refined_.points[edge.b].mapped.image}, half_extent_)) return; // its other face may have been dropped
    block.open.push_back({edge.a, edge.b, 1});
    if (source.faces == 1) return;
    ++block.unexplained;
    block.widest_gap = std::max(block.widest_gap, 2.0 * edge.error);
  }

  bool is_rim(const RefinedEdge& edge) const { return share_boundary(refined_.points[edge.a].sides, refined_.points[edge.b].sides); }

  const RefinedMesh& refined_;
  const EdgeOracle& oracle_;
  Vec2 half_extent_;
  std::vector<std::uint32_t> faces_; ///< drawn, per edge
};

std::size_t count_t_junctions(const RefinedMesh& refined, const MeshTopology& open) {
  if (open.edges.empty()) return 0;
  std::vector<Vec3> points(refined.points.size());
  parallel_each(points.size(), block_size, [&](std::size_t i) { points[i] = refined.points[i].eye; });
  return find_t_junctions(points, open).size();
}

} // namespace

void audit_edges(const RefinedMesh& refined, const EdgeOracle& oracle, const Raster& raster, const RefineOptions& options, RefineReport& report) {
  std::vector<float> errors(refined.whole.size());
  for (std::size_t i = 0; i < errors.size(); ++i) errors[i] = refined.whole[i].error;
  report.depth_error_max = std::max({report.depth_error_max, static_cast<double>(refined.whole_depth_error), refined.face_depth_error, static_cast<double>(refined.slide_depth_error)});
  MeshTopology open;
  for (const EdgeBlock& block : EdgeAudit(refined, oracle, kept_half_extent(options, raster)).run()) {
    errors.insert(errors.end(), block.errors.begin(), block.errors.end());
    open.edges.insert(open.edges.end(), block.open.begin(), block.open.end());
    report.depth_error_max = std::max(report.depth_error_max, block.depth_error);
    report.slide_px_max = std::max(report.slide_px_max, block.slide / pixel_size(raster));
    report.uncertified_edges += block.uncertified;
    report.open_edges += block.unexplained;
    report.max_gap_px = std::max(report.max_gap_px, block.widest_gap / pixel_size(raster));
  }
  report.t_junctions_out += count_t_junctions(refined, open);
  add_errors(errors, raster, report);
}

void add_errors(std::vector<float>& errors, const Raster& raster, RefineReport& report) {
  if (errors.empty()) return;
  const double px = 1 / pixel_size(raster);
  double sum = 0;
  for (const float error : errors) sum += error;
  report.error_px_p99 = std::max(report.error_px_p99, quantile(errors, 100) * px);
  report.error_px_mean = std::max(report.error_px_mean, sum / static_cast<double>(errors.size()) * px);
  report.error_px_max = std::max(report.error_px_max, *std::max_element(errors.begin(), errors.end()) * px);
}

} // namespace domewarp
