// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <utility>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

struct Pictures {
  const Frame& reference;
  const Frame& warped;
  const CompareOptions& options;
  std::vector<std::uint32_t> object; ///< of the warped picture, in the reference's numbers; 0 where nothing is covered
};

bool is_near(double depth, double reference, double tolerance) {
  return std::isnan(depth) || std::abs(depth - reference) <= tolerance * reference;
}

/// A written file lacks the objects nobody sees, so its objects are numbered otherwise. Each takes the number of the
/// object that the reference shows at its depth in most of its pixels; one that never agrees gets a number of its own.
std::vector<std::uint32_t> match_objects(const Pictures& p) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> votes;
  std::map<std::uint32_t, std::pair<std::size_t, std::uint32_t>> best;
  for (std::size_t i = 0; i < p.warped.object.size(); ++i) {
    const std::uint32_t warped = p.warped.object[i], reference = p.reference.object[i];
    if (!warped || !reference || !is_near(p.warped.depth[i], p.reference.depth[i], p.options.depth_tolerance)) continue;
    ++votes[{warped, reference}];
  }
  for (const auto& [pair, count] : votes)
    if (count > best[pair.first].first) best[pair.first] = {count, pair.second};
  constexpr std::uint32_t unknown = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> object(p.warped.object.size(), 0);
  for (std::size_t i = 0; i < object.size(); ++i)
    if (const std::uint32_t warped = p.warped.object[i])
      object[i] = best.contains(warped) ? best[warped].second : unknown;
  return object;
}

/// Calls visit(pixel) for the pixel and its neighbours inside the picture.
template <typename Visit>
void for_each_neighbour(const Frame& frame, int column, int row, Visit&& visit) {
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, frame.height - 1); ++y)
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, frame.width - 1); ++x)
      visit(std::size_t(y) * std::size_t(frame.width) + std::size_t(x));
}

bool is_pinhole(const Pictures& p, int column, int row) {
  if (column < 1 || row < 1 || column > p.reference.width - 2 || row > p.reference.height - 2) return false;
  bool inside = true;
  for_each_neighbour(p.reference, column, row, [&](std::size_t i) { inside = inside && p.reference.object[i] != 0; });
  return inside;
}

/// Whether the reference shows the object at the depth within the 3 x 3 pixels. The depth may lie anywhere between
/// theirs: a surface at a slant changes depth by more than any tolerance within a pixel, and where two walls meet
/// either may end up deeper than it gets in its own pixels. Without source positions the object alone decides.
bool is_shown(const Pictures& p, int column, int row, std::uint32_t object, double depth) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  bool found = false;
  for_each_neighbour(p.reference, column, row, [&](std::size_t i) {
    if (!p.reference.object[i]) return;
    found = found || p.reference.object[i] == object;
    low = std::min(low, double(p.reference.depth[i]));
    high = std::max(high, double(p.reference.depth[i]));
  });
  const double tolerance = p.options.depth_tolerance;
  return found && (std::isnan(depth) || (depth >= low * (1 - tolerance) && depth <= high * (1 + tolerance)));
}

/// Inside a surface: one object all around, whose depth changes evenly in all four directions across the pixel.
bool is_smooth(const Pictures& p, int column, int row) {
  const Frame& f = p.reference;
  if (column < 1 || row < 1 || column > f.width - 2 || row > f.height - 2) return false;
  const std::size_t i = std::size_t(row) * std::size_t(f.width) + std::size_t(column), line = std::size_t(f.width);
  for (const std::size_t step : {std::size_t{1}, line - 1, line, line + 1}) {
    if (f.object[i - step] != f.object[i] || f.object[i + step] != f.object[i]) return false;
    const double bend = double(f.depth[i - step]) + double(f.depth[i + step]) - 2.0 * f.depth[i];
    if (!(std::abs(bend) <= p.options.depth_tolerance * f.depth[i])) return false;
  }
  return true;
}

Verdict judge(const Pictures& p, int column, int row) {
  const std::size_t i = std::size_t(row) * std::size_t(p.reference.width) + std::size_t(column);
  const bool in_reference = p.reference.object[i] != 0, in_warped = p.warped.object[i] != 0;
  if (!in_reference) return in_warped ? Verdict::warped_only : Verdict::background;
  if (!in_warped) return is_pinhole(p, column, row) ? Verdict::pinhole : Verdict::reference_only;
  return is_shown(p, column, row, p.object[i], p.warped.depth[i]) ? Verdict::same : Verdict::mismatch;
}

/// NaN where the pixel is at an outline or a crease, or no depth is known.
double depth_difference(const Pictures& p, int column, int row) {
  const std::size_t i = std::size_t(row) * std::size_t(p.reference.width) + std::size_t(column);
  if (p.object[i] != p.reference.object[i] || !is_smooth(p, column, row))
    return std::numeric_limits<double>::quiet_NaN();
  const double reference = p.reference.depth[i];
  return std::abs(p.warped.depth[i] - reference) / reference;
}

double displacement_px(const Surface& surface, const ImageMap& map, const Raster& raster, const Vec3f& position,
                       int column, int row) {
  const Vec3 p(position);
  const double length = glm::length(p);
  if (!(length > 0) || !std::isfinite(length)) return std::numeric_limits<double>::quiet_NaN();
  const Vec2 centre = pixel_centre(raster, column, row);
  const double radius = glm::length(centre), pixel = pixel_size(raster);
  double best = std::numeric_limits<double>::infinity();
  for (const BranchMap& branch : map.branches) {
    const auto [low, high] = std::minmax({branch.branch().radius_low, branch.branch().radius_high});
    if (radius >= low - pixel && radius <= high + pixel) best = std::min(best, glm::length(branch.image(p) - centre));
  }
  if (best > 1e300) best = glm::length(map.branches[surface.branch_at(radius)].image(p) - centre);
  return best / pixel;
}

void judge_rows(const Pictures& p, const Surface& surface, const ImageMap& map, const Raster& raster,
                CompareReport& report) {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  report.displacement.assign(p.reference.object.size(), none);
  report.verdicts.assign(p.reference.object.size(), Verdict::background);
  parallel_each(std::size_t(p.reference.height), 8, [&](std::size_t line) {
    const int row = static_cast<int>(line);
    for (int column = 0; column < p.reference.width; ++column) {
      const std::size_t i = line * std::size_t(p.reference.width) + std::size_t(column);
      report.verdicts[i] = judge(p, column, row);
      if (p.warped.object[i])
        report.displacement[i] =
            static_cast<float>(displacement_px(surface, map, raster, p.warped.position[i], column, row));
    }
  });
}

void count_verdicts(const Pictures& p, CompareReport& report) {
  for (std::size_t i = 0; i < report.verdicts.size(); ++i) {
    report.coverage.reference += p.reference.object[i] != 0;
    report.coverage.warped += p.warped.object[i] != 0;
    report.coverage.both += p.reference.object[i] != 0 && p.warped.object[i] != 0;
    report.pinholes += report.verdicts[i] == Verdict::pinhole;
    report.surface_mismatch += report.verdicts[i] == Verdict::mismatch;
  }
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
  // At most one pixel in a thousand lies above.
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(values.size() - 1 - values.size() / 1000);
  std::nth_element(values.begin(), nth, values.end());
  d.p999 = *nth;
}

void summarise_depth(const Pictures& p, CompareReport& report) {
  for (int row = 0; row < p.reference.height; ++row)
    for (int column = 0; column < p.reference.width; ++column) {
      const std::size_t i = std::size_t(row) * std::size_t(p.reference.width) + std::size_t(column);
      if (!p.reference.object[i] || !p.warped.object[i]) continue;
      const double difference = depth_difference(p, column, row);
      if (std::isnan(difference)) continue;
      ++report.depth_rel.measured;
      report.depth_rel.max = std::max(report.depth_rel.max, difference);
    }
}

void summarise_colours(const Pictures& p, CompareReport& report) {
  double squares = 0, sum = 0;
  for (std::size_t i = 0; i < p.reference.object.size(); ++i)
    for (std::size_t k = 4 * i; k < 4 * i + 3; ++k) {
      const int difference = std::abs(int(p.reference.rgba[k]) - int(p.warped.rgba[k]));
      squares += difference * difference;
      if (p.reference.object[i] && p.warped.object[i]) sum += difference;
    }
  const double samples = 3.0 * static_cast<double>(p.reference.object.size());
  if (squares > 0) report.psnr_db = 10 * std::log10(255.0 * 255.0 * samples / squares);
  if (report.coverage.both) report.colour_difference = sum / (3.0 * static_cast<double>(report.coverage.both));
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

} // namespace

CompareReport compare_frames(const Frame& reference, const Frame& warped, const Surface& surface, const ImageMap& map,
                             const Raster& raster, const CompareOptions& options) {
  for (const Frame* frame : {&reference, &warped})
    if (frame->width != raster.width || frame->height != raster.height)
      throw Error(ErrorCode::usage, "compare: a picture of " + size_text(frame->width, frame->height) +
                                        " pixels does not fit --size " + size_text(raster.width, raster.height));
  Pictures pictures{reference, warped, options, {}};
  pictures.object = match_objects(pictures);
  CompareReport report;
  judge_rows(pictures, surface, map, raster, report);
  count_verdicts(pictures, report);
  summarise_displacement(raster.width, report);
  summarise_depth(pictures, report);
  summarise_colours(pictures, report);
  return report;
}

std::string to_json(const CompareReport& report) {
  nlohmann::ordered_json json;
  const auto& c = report.coverage;
  json["coverage"] = {{"reference", c.reference}, {"warped", c.warped}, {"both", c.both}};
  json["pinholes"] = report.pinholes;
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
    json["depth_rel"] = {{"max", report.depth_rel.max}, {"measured", report.depth_rel.measured}};
  json["psnr_db"] = nullptr;
  if (report.psnr_db) json["psnr_db"] = *report.psnr_db;
  json["colour_difference"] = report.colour_difference;
  return json.dump(2);
}

} // namespace domewarp
