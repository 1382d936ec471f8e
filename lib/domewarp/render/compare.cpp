// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/core/quantile.h"

namespace domewarp {

namespace {

/// How near depths must be to vote for two objects being one.
constexpr double same_depth = 0.01;

/// How far (relative to its distance) a source position may lie off the plane that the reference shows around it.
constexpr double position_rounding = 2e-5;

struct Pictures {
  const Frame& reference;
  const Frame& warped;
  std::vector<std::uint32_t> object; ///< of the warped picture, in the reference's numbers; 0 where nothing is covered

  std::size_t index(int column, int row) const {
    return std::size_t(row) * std::size_t(reference.width) + std::size_t(column);
  }
};

constexpr std::uint32_t unknown_object = std::numeric_limits<std::uint32_t>::max();

bool is_near(double depth, double reference) {
  return std::isnan(depth) || std::abs(depth - reference) <= same_depth * reference;
}

/// A written file lacks the objects nobody sees, so its objects are numbered otherwise. Each takes the number of the
/// object that the reference shows at its depth in most of its pixels; one that never agrees gets a number of its own.
std::vector<std::uint32_t> match_objects(const Pictures& p) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> votes;
  std::map<std::uint32_t, std::pair<std::size_t, std::uint32_t>> best;
  for (std::size_t i = 0; i < p.warped.object.size(); ++i) {
    const std::uint32_t warped = p.warped.object[i], reference = p.reference.object[i];
    if (!warped || !reference || !is_near(p.warped.depth[i], p.reference.depth[i])) continue;
    ++votes[{warped, reference}];
  }
  for (const auto& [pair, count] : votes)
    if (count > best[pair.first].first) best[pair.first] = {count, pair.second};
  std::vector<std::uint32_t> object(p.warped.object.size(), 0);
  for (std::size_t i = 0; i < object.size(); ++i)
    if (const std::uint32_t warped = p.warped.object[i])
      object[i] = best.contains(warped) ? best[warped].second : unknown_object;
  return object;
}

/// The plane of the triangle that the reference shows at a pixel, from its own pixel and one neighbour each way that
/// shows the same triangle. @return false when there are none.
bool find_plane(const Pictures& p, int column, int row, Vec3& normal, double& offset) {
  const Frame& f = p.reference;
  const std::size_t i = p.index(column, row);
  const auto same = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= f.width || y >= f.height) return false;
    const std::size_t k = p.index(x, y);
    return f.object[k] == f.object[i] && f.triangle[k] == f.triangle[i];
  };
  const int dx = same(column + 1, row) ? 1 : same(column - 1, row) ? -1 : 0;
  const int dy = same(column, row + 1) ? 1 : same(column, row - 1) ? -1 : 0;
  if (dx == 0 || dy == 0) return false;
  const Vec3 at(f.position[i]);
  normal = glm::cross(Vec3(f.position[p.index(column + dx, row)]) - at, Vec3(f.position[p.index(column, row + dy)]) - at);
  const double length = glm::length(normal);
  if (!(length > 0)) return false;
  normal /= length;
  offset = glm::dot(normal, at);
  return true;
}

/// Whether both pictures show the same object in the same plane at about the same distance.
bool is_plainly_same(const Pictures& p, int column, int row) {
  const std::size_t i = p.index(column, row);
  if (p.object[i] != p.reference.object[i] || std::isnan(p.warped.depth[i])) return false;
  Vec3 normal;
  double offset = 0;
  if (!is_near(p.warped.depth[i], p.reference.depth[i]) || !find_plane(p, column, row, normal, offset)) return false;
  return std::abs(glm::dot(normal, Vec3(p.warped.position[i])) - offset) <= position_rounding * p.warped.depth[i];
}

/// How a drawn point lies to what it shows.
struct Drawn {
  double displacement = std::numeric_limits<double>::quiet_NaN(); ///< px
  double depth_off = std::numeric_limits<double>::quiet_NaN();    ///< relative
};

/// By the branch that owns the pixel's radius, or the neighbour within a pixel of its end that fits better.
Drawn measure_drawn(const Pictures& p, const Screen& screen, const Surface& surface, const ImageMap& map,
                    const Raster& raster, int column, int row) {
  const std::size_t i = p.index(column, row);
  const Vec3 at(p.warped.position[i]);
  const double length = glm::length(at);
  if (!(length > 0) || !std::isfinite(length)) return {};
  const Vec2 centre = pixel_centre(raster, column, row);
  const double radius = glm::length(centre), pixel = pixel_size(raster);
  double best = std::numeric_limits<double>::infinity();
  const BranchMap* of_best = nullptr;
  const auto try_branch = [&](const BranchMap& branch) {
    const double distance = glm::length(branch.image(at) - centre);
    if (distance < best) best = distance, of_best = &branch;
  };
  for (const BranchMap& branch : map.branches) {
    const auto [low, high] = std::minmax({branch.branch().radius_low, branch.branch().radius_high});
    if (radius >= low - pixel && radius <= high + pixel) try_branch(branch);
  }
  if (!of_best) try_branch(map.branches[surface.branch_at(radius)]);
  if (!of_best) return {};
  const double exact = length * (screen.perspective ? of_best->factors(at).g : 1.0);
  const bool is_rasterised = !p.warped.drawn_depth.empty();
  return {best / pixel, is_rasterised ? std::abs(p.warped.drawn_depth[i] / exact - 1) : Drawn{}.depth_off};
}

struct Judged {
  Verdict verdict = Verdict::background;
  bool arbitrated = false;
};

Judged judge_pixel(const Pictures& p, const PixelJudge& judge, int column, int row, double displacement,
                   Search search = Search::quick) {
  const std::size_t i = p.index(column, row);
  if (!p.warped.object[i]) {
    if (!p.reference.object[i]) return {Verdict::background, false};
    return {judge.judge_bare(column, row, search), true};
  }
  if (is_plainly_same(p, column, row)) return {Verdict::same, false};
  const std::uint32_t object = p.object[i] == unknown_object ? 0 : p.object[i];
  if (std::isnan(displacement)) {
    if (p.object[i] == p.reference.object[i]) return {Verdict::same, false};
    return {judge.judge_object(column, row, object, search), true};
  }
  return {judge.judge_drawn(column, row, Vec3(p.warped.position[i]), object, displacement, search), true};
}

void judge_rows(const Pictures& p, const Screen& screen, const PixelJudge& judge, const Surface& surface,
                const ImageMap& map, const Raster& raster, CompareReport& report) {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  report.displacement.assign(p.reference.object.size(), none);
  report.depth_off.assign(p.reference.object.size(), none);
  report.verdicts.assign(p.reference.object.size(), Verdict::background);
  std::vector<std::size_t> arbitrated(std::size_t(raster.height), 0);
  parallel_each(std::size_t(raster.height), 4, [&](std::size_t line) {
    const int row = static_cast<int>(line);
    for (int column = 0; column < raster.width; ++column) {
      const std::size_t i = p.index(column, row);
      Drawn drawn;
      if (p.warped.object[i]) drawn = measure_drawn(p, screen, surface, map, raster, column, row);
      report.displacement[i] = static_cast<float>(drawn.displacement);
      report.depth_off[i] = static_cast<float>(drawn.depth_off);
      const Judged judged = judge_pixel(p, judge, column, row, drawn.displacement);
      report.verdicts[i] = judged.verdict;
      arbitrated[line] += judged.arbitrated;
    }
  });
  report.arbitrated = std::accumulate(arbitrated.begin(), arbitrated.end(), std::size_t{0});
}

/// More flaws than these are no matter of slivers and holes: they stand without a close search.
constexpr std::size_t few_flaws = 1000;

bool is_flaw(Verdict verdict) {
  return verdict == Verdict::pinhole || verdict == Verdict::seam_pinhole || verdict == Verdict::mismatch ||
         verdict == Verdict::seam_mismatch;
}

void judge_flaws_closely(const Pictures& p, const PixelJudge& judge, CompareReport& report) {
  std::vector<std::size_t> flaws;
  for (std::size_t i = 0; i < report.verdicts.size(); ++i)
    if (is_flaw(report.verdicts[i])) flaws.push_back(i);
  if (flaws.size() > few_flaws) return;
  parallel_each(flaws.size(), 1, [&](std::size_t k) {
    const std::size_t i = flaws[k], width = std::size_t(p.warped.width);
    report.verdicts[i] = judge_pixel(p, judge, static_cast<int>(i % width), static_cast<int>(i / width),
                                     double(report.displacement[i]), Search::close).verdict;
  });
}

void count_verdicts(const Pictures& p, CompareReport& report) {
  std::array<std::size_t, 8> count{};
  for (std::size_t i = 0; i < report.verdicts.size(); ++i) {
    report.coverage.reference += p.reference.object[i] != 0;
    report.coverage.warped += p.warped.object[i] != 0;
    report.coverage.both += p.reference.object[i] != 0 && p.warped.object[i] != 0;
    ++count[static_cast<std::size_t>(report.verdicts[i])];
  }
  const auto of = [&count](Verdict verdict) { return count[static_cast<std::size_t>(verdict)]; };
  report.pinholes_at_seams = of(Verdict::seam_pinhole);
  report.pinholes = of(Verdict::pinhole) + report.pinholes_at_seams;
  report.surface_mismatch_at_seams = of(Verdict::seam_mismatch);
  report.surface_mismatch = of(Verdict::mismatch) + report.surface_mismatch_at_seams;
  report.outline = of(Verdict::outline);
  report.depth_ties = of(Verdict::depth_tie);
}

/// Lists the first pixels that is_flaw() says yes to.
template <typename IsFlaw>
void list_flaws(int width, std::size_t pixels, IsFlaw&& is_flaw, CompareReport& report) {
  constexpr int most = 32;
  int listed = 0;
  for (std::size_t i = 0; i < pixels && listed < most; ++i)
    if (is_flaw(i)) report.flaws.push_back({static_cast<int>(i % std::size_t(width)), static_cast<int>(i / std::size_t(width))}), ++listed;
}

void list_flaws(int width, CompareReport& report) {
  const auto verdict_is = [&report](Verdict a, Verdict b) {
    return [&report, a, b](std::size_t i) { return report.verdicts[i] == a || report.verdicts[i] == b; };
  };
  list_flaws(width, report.verdicts.size(), verdict_is(Verdict::pinhole, Verdict::seam_pinhole), report);
  list_flaws(width, report.verdicts.size(), verdict_is(Verdict::mismatch, Verdict::seam_mismatch), report);
  list_flaws(width, report.covers.size(), [&report](std::size_t i) { return report.covers[i] > 1; }, report);
}

/// A surface that covers a pixel twice is an overlap unless the scene has as many triangles there.
void find_overlaps(const Pictures& p, const Screen& screen, const PixelJudge& judge, double depth_bound,
                   CompareReport& report) {
  if (!screen.has_source) return;
  report.covers = count_covers(screen, p.warped, depth_bound);
  const auto keep_flawed = [&](const std::vector<std::size_t>& pixels, Search search) {
    parallel_each(pixels.size(), 16, [&](std::size_t k) {
      const std::size_t i = pixels[k], width = std::size_t(p.warped.width);
      if (p.object[i] == unknown_object ||
          judge.has_triangles(static_cast<int>(i % width), static_cast<int>(i / width), p.object[i], p.warped.depth[i], report.covers[i], search))
        report.covers[i] = 0;
    });
    std::vector<std::size_t> kept;
    std::copy_if(pixels.begin(), pixels.end(), std::back_inserter(kept), [&](std::size_t i) { return report.covers[i] > 0; });
    return kept;
  };
  std::vector<std::size_t> overlaps;
  for (std::size_t i = 0; i < report.covers.size(); ++i) {
    if (report.covers[i] > 1) overlaps.push_back(i);
    else report.covers[i] = 0;
  }
  overlaps = keep_flawed(overlaps, Search::quick);
  if (overlaps.size() <= few_flaws) overlaps = keep_flawed(overlaps, Search::close);
  report.overlaps = overlaps.size();
}

/// Sums over the pixels in their order, whatever threads filled them.
void summarise_displacement(int width, CompareReport& report) {
  std::vector<float> values;
  double squares = 0;
  DisplacementReport& d = report.displacement_px;
  for (std::size_t i = 0; i < report.displacement.size(); ++i) {
    const float value = report.displacement[i];
    if (std::isnan(value)) continue;
    values.push_back(value);
    squares += double(value) * value;
    if (d.worst_column >= 0 && value <= d.max) continue;
    d.max = value;
    d.worst_column = static_cast<int>(i % std::size_t(width));
    d.worst_row = static_cast<int>(i / std::size_t(width));
  }
  d.measured = values.size();
  if (values.empty()) return;
  d.rms = std::sqrt(squares / static_cast<double>(values.size()));
  d.p999 = quantile(values, 1000);
}

void summarise_depth(int width, CompareReport& report) {
  DepthReport& d = report.depth_rel;
  for (std::size_t i = 0; i < report.depth_off.size(); ++i) {
    if (std::isnan(report.depth_off[i])) continue;
    ++d.measured;
    if (d.worst_column >= 0 && report.depth_off[i] <= d.max) continue;
    d.max = report.depth_off[i];
    d.worst_column = static_cast<int>(i % std::size_t(width));
    d.worst_row = static_cast<int>(i / std::size_t(width));
  }
}

void summarise_colours(const Pictures& p, CompareReport& report) {
  double sum = 0;
  for (std::size_t i = 0; i < p.reference.object.size(); ++i)
    for (std::size_t k = 4 * i; k < 4 * i + 3; ++k)
      if (p.reference.object[i] && p.warped.object[i])
        sum += std::abs(int(p.reference.rgba[k]) - int(p.warped.rgba[k]));
  if (report.coverage.both) report.colour_difference = sum / (3.0 * static_cast<double>(report.coverage.both));
  const Pixels reference = colours(p.reference), warped = colours(p.warped);
  report.psnr_db = psnr_db(reference, warped);
  report.ssim = structural_similarity(reference, warped);
  report.flip = flip(reference, warped);
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

} // namespace

CompareReport compare_frames(const Frame& reference, const Frame& warped, const Screen& screen, const Surface& surface,
                             const ImageMap& map, const Raster& raster, const CrossingsAlong& crossings,
                             const CompareOptions& options) {
  for (const Frame* frame : {&reference, &warped})
    if (frame->width != raster.width || frame->height != raster.height)
      throw Error(ErrorCode::usage, "compare: a picture of " + size_text(frame->width, frame->height) +
                                        " pixels does not fit --size " + size_text(raster.width, raster.height));
  Pictures pictures{reference, warped, {}};
  pictures.object = match_objects(pictures);
  const PixelJudge judge(surface, raster, crossings, options.bound_px, options.depth_bound);
  CompareReport report;
  judge_rows(pictures, screen, judge, surface, map, raster, report);
  judge_flaws_closely(pictures, judge, report);
  count_verdicts(pictures, report);
  find_overlaps(pictures, screen, judge, options.depth_bound, report);
  list_flaws(raster.width, report);
  summarise_displacement(raster.width, report);
  summarise_depth(raster.width, report);
  summarise_colours(pictures, report);
  return report;
}

std::string to_json(const CompareReport& report) {
  nlohmann::ordered_json json;
  const auto& c = report.coverage;
  json["coverage"] = {{"reference", c.reference}, {"warped", c.warped}, {"both", c.both}};
  json["pinholes"] = report.pinholes;
  json["overlaps"] = nullptr;
  if (report.overlaps) json["overlaps"] = *report.overlaps;
  json["surface_mismatch"] = report.surface_mismatch;
  const auto& d = report.displacement_px;
  json["displacement_px"] = nullptr;
  if (d.measured)
    json["displacement_px"] = {{"max", d.max},
                               {"p999", d.p999},
                               {"rms", d.rms},
                               {"measured", d.measured},
                               {"worst", {d.worst_column, d.worst_row}}};
  json["depth_rel"] = nullptr;
  if (report.depth_rel.measured)
    json["depth_rel"] = {{"max", report.depth_rel.max},
                         {"measured", report.depth_rel.measured},
                         {"worst", {report.depth_rel.worst_column, report.depth_rel.worst_row}}};
  json["psnr_db"] = nullptr;
  if (report.psnr_db) json["psnr_db"] = *report.psnr_db;
  json["ssim"] = nullptr;
  if (report.ssim) json["ssim"] = *report.ssim;
  json["flip"] = {{"mean", report.flip.mean}, {"max", report.flip.max}};
  json["colour_difference"] = report.colour_difference;
  json["pinholes_at_seams"] = report.pinholes_at_seams;
  json["surface_mismatch_at_seams"] = report.surface_mismatch_at_seams;
  json["flaws"] = report.flaws;
  json["outline"] = report.outline;
  json["depth_ties"] = report.depth_ties;
  json["arbitrated"] = report.arbitrated;
  return json.dump(2);
}

} // namespace domewarp
