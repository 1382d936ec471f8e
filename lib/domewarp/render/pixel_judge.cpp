// SPDX-License-Identifier: Apache-2.0
//
// A picture in which everything may be displaced by a bound shows, at a pixel, any surface that nothing hides somewhere
// within the bound around the pixel. So the rays around a pixel decide: at its centre, at the place of what it shows,
// and on two circles, the outer one with the bound as its radius. A close search looks over
// the whole disc for what they may have missed: a sliver, or a hole in a masked texture.
#include "domewarp/render/pixel_judge.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "domewarp/transform/image_map.h"

namespace domewarp {

namespace {

/// Source positions are float32, interpolated by the driver: how far (relative to the distance) one may lie off its
/// plane.
constexpr double position_rounding = 2e-5;

/// Two double-precision distances along one ray that differ by less (relative) are equal.
constexpr double distance_rounding = 1e-9;

/// Crossings of one object or piece that are nearer than this (relative) in neighbouring rays belong together.
constexpr double sheet_thickness = 0.01;

/// A plane through a piece of surface.
struct Sheet {
  Vec3 normal;
  double offset;
  std::uint32_t object, piece;

  double distance(const Vec3& direction) const { return offset / glm::dot(direction, normal); }
};

Sheet sheet_of(const Crossing& crossing, const Vec3& direction) {
  return {crossing.normal, crossing.distance * glm::dot(direction, crossing.normal), crossing.object, crossing.piece};
}

/// Whether something is nearer than the sheet by more than the margin (relative).
bool is_hidden(const std::vector<Crossing>& crossings, double sheet_distance, double margin) {
  return !crossings.empty() && crossings.front().distance < sheet_distance * (1 - margin);
}

} // namespace

struct PixelJudge::Probe {
  Vec3 direction;
  std::vector<Crossing> crossings;
};

/// The rays around a pixel, traced as they are asked for: the centre first, then the circle of the bound, then one of
/// half its radius, each turned by half a step against the other; then Vogel's spiral, whose rays lie evenly, a 25th of
/// the bound apart.
class PixelJudge::Probes {
 public:
  static constexpr int outer = 16, inner = 8, few = 1 + outer + inner, spiral = 2048;

  Probes(const PixelJudge& judge, int column, int row, Search search)
      : judge_(judge), column_(column), row_(row), count_(search == Search::close ? few + spiral : few) {}

  std::size_t count() const { return count_; }

  /// Beyond r_max there are no crossings, and the direction is zero.
  const Probe& operator[](std::size_t i) {
    while (probes_.size() <= i) probes_.push_back(trace(static_cast<int>(probes_.size())));
    return probes_[i];
  }

  template <typename Test>
  bool any(Test&& test) {
    for (std::size_t i = 0; i < count_; ++i)
      if (test((*this)[i])) return true;
    return false;
  }

 private:
  Probe trace(int i) const {
    Vec2 offset(0);
    if (i >= few) {
      const double angle = (i - few) * std::numbers::pi * (3 - std::sqrt(5.0)); // golden
      offset = judge_.bound_px_ * std::sqrt((i - few + 0.5) / spiral) * Vec2(std::cos(angle), std::sin(angle));
    } else if (i > 0) {
      const bool on_outer = i <= outer;
      const double turn = on_outer ? double(i - 1) / outer : (i - outer - 0.5) / inner;
      const double angle = 2 * std::numbers::pi * turn;
      offset = (on_outer ? 1.0 : 0.5) * judge_.bound_px_ * Vec2(std::cos(angle), std::sin(angle));
    }
    Probe probe{Vec3(0), {}};
    if (unproject(judge_.surface_, pixel_centre(judge_.raster_, column_ + offset.x, row_ + offset.y), probe.direction))
      probe.crossings = judge_.crossings_(probe.direction);
    else
      probe.direction = Vec3(0);
    return probe;
  }

  const PixelJudge& judge_;
  int column_, row_;
  std::size_t count_;
  std::deque<Probe> probes_; // references stay valid while others are traced
};

PixelJudge::PixelJudge(const Surface& surface, const Raster& raster, CrossingsAlong crossings, double bound_px,
                       double depth_bound)
    : surface_(surface), raster_(raster), crossings_(std::move(crossings)), bound_px_(bound_px),
      depth_bound_(depth_bound) {}

namespace {

/// The piece of surface among the crossings that p lies on, of the given object if one of them is.
std::optional<Sheet> find_sheet(const std::vector<Crossing>& crossings, const Vec3& direction, const Vec3& p,
                                std::uint32_t object) {
  const double length = glm::length(p);
  std::optional<Sheet> found;
  for (const Crossing& crossing : crossings) {
    const Sheet sheet = sheet_of(crossing, direction);
    if (std::abs(glm::dot(p, sheet.normal) - sheet.offset) > position_rounding * length) continue;
    if (std::abs(crossing.distance - length) > 0.5 * length) continue;
    if (crossing.object == object) return sheet;
    if (!found) found = sheet;
  }
  return found;
}

/// Whether a connected piece of surface goes on along another ray.
bool goes_on(const Sheet& sheet, const Vec3& direction, const std::vector<Crossing>& crossings) {
  const double distance = sheet.distance(direction);
  return std::any_of(crossings.begin(), crossings.end(), [&](const Crossing& c) {
    return c.piece == sheet.piece && std::abs(c.distance - distance) <= sheet_thickness * distance;
  });
}

} // namespace

Verdict PixelJudge::judge_drawn(int column, int row, const Vec3& p, std::uint32_t object,
                                double displacement_px, Search search) const {
  const double length = glm::length(p);
  if (!(displacement_px <= bound_px_ + 1e-3) || !(length > 0)) return Verdict::mismatch;
  Probes probes(*this, column, row, search);
  const Vec3 own = p / length;
  const std::vector<Crossing> own_crossings = crossings_(own);
  std::optional<Sheet> sheet = find_sheet(own_crossings, own, p, object);
  for (std::size_t i = 0; i < probes.count() && !sheet; ++i)
    sheet = find_sheet(probes[i].crossings, probes[i].direction, p, object);
  if (!sheet) return Verdict::mismatch;

  const Probe& centre = probes[0];
  const bool on_picture = centre.direction != Vec3(0);
  const double distance = on_picture ? sheet->distance(centre.direction) : 0;
  if (on_picture && !centre.crossings.empty()) {
    const Crossing& first = centre.crossings.front();
    const double gap = std::abs(first.distance - distance);
    if (gap <= distance_rounding * distance) return Verdict::same;
    if (gap <= depth_bound_ * distance) return first.object == sheet->object ? Verdict::same : Verdict::depth_tie;
  }
  if (!is_hidden(own_crossings, length, position_rounding)) return Verdict::outline;
  const auto shows = [&](double margin) {
    return probes.any([&](const Probe& probe) {
      if (probe.direction == Vec3(0)) return false;
      const double at = sheet->distance(probe.direction);
      return at > 0 && !is_hidden(probe.crossings, at, margin);
    });
  };
  if (shows(distance_rounding)) return Verdict::outline;
  if (shows(depth_bound_)) return Verdict::depth_tie;
  // What hides it is cut off at the rim, by a chord of its own.
  if (probes.any([](const Probe& probe) { return probe.direction == Vec3(0); })) return Verdict::outline;
  for (const Crossing& crossing : centre.crossings) {
    if (crossing.distance >= distance * (1 - depth_bound_)) break;
    const Sheet hiding = sheet_of(crossing, centre.direction);
    const auto ends = [&](const Probe& probe) { return !goes_on(hiding, probe.direction, probe.crossings); };
    if (!probes.any(ends)) return Verdict::mismatch;
  }
  return Verdict::seam_mismatch;
}

Verdict PixelJudge::judge_object(int column, int row, std::uint32_t object, Search search) const {
  Probes probes(*this, column, row, search);
  const auto shows = [object](const Probe& probe) {
    return !probe.crossings.empty() && probe.crossings.front().object == object;
  };
  if (shows(probes[0])) return Verdict::same;
  return probes.any(shows) ? Verdict::outline : Verdict::mismatch;
}

Verdict PixelJudge::judge_bare(int column, int row, Search search) const {
  Probes probes(*this, column, row, search);
  if (probes.any([](const Probe& probe) { return probe.crossings.empty(); })) return Verdict::outline;
  for (const Crossing& crossing : probes[0].crossings) {
    const Sheet sheet = sheet_of(crossing, probes[0].direction);
    const auto ends = [&](const Probe& probe) { return !goes_on(sheet, probe.direction, probe.crossings); };
    if (!probes.any(ends)) return Verdict::pinhole;
  }
  return Verdict::seam_pinhole;
}

bool PixelJudge::has_triangles(int column, int row, std::uint32_t object, double distance, std::size_t count,
                               Search search) const {
  Probes probes(*this, column, row, search);
  std::set<std::uint32_t> triangles;
  return probes.any([&](const Probe& probe) {
    for (const Crossing& c : probe.crossings)
      if (c.object == object && std::abs(c.distance - distance) <= sheet_thickness * distance)
        triangles.insert(c.triangle);
    return triangles.size() >= count;
  });
}

} // namespace domewarp
