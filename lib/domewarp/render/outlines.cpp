// SPDX-License-Identifier: Apache-2.0
//
// Rays through pixel centres miss what is smaller than a pixel, and then no contrast tells that something was missed
// (Figure 20 of the thesis). But everything that begins or ends in a picture does so at an outline, and the map from the
// scene to the picture says where those are.
#include "domewarp/render/outlines.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>
#include <tbb/parallel_sort.h>

#include "domewarp/core/parallel.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

namespace {

constexpr double longest_step = 0.5;   ///< pixels
constexpr double half_width = 0.3;     ///< of the square that is marked around every step's end, pixels
constexpr double widest_angle = 0.1;   ///< chord between two unit directions: longer steps are not trusted to be straight
constexpr int most_halvings = 24;

/// Distances are kept as eighths of octaves, rounded down, so that an outline never counts as farther than it is.
constexpr int levels_per_octave = 8, middle_level = 128, no_outline = 255;

std::uint8_t level_of(double distance) {
  const double level = std::floor(levels_per_octave * std::log2(distance)) + middle_level;
  return static_cast<std::uint8_t>(std::clamp(level, 0.0, no_outline - 1.0));
}

std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

std::uint64_t hash_of(const Vec3& v) {
  std::uint64_t hash = 0;
  for (int i = 0; i < 3; ++i) hash = mix(hash ^ std::bit_cast<std::uint64_t>(v[i] + 0.0)); // -0 becomes +0
  return hash;
}

/// One side of a triangle that can be seen. Sides with equal keys are one edge.
struct Side {
  std::uint64_t key;
  const Look* look;
  bool front;
  Vec3 a, b; ///< eye space
};

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void append_sides(const Part& part, const View& view, std::vector<Side>& sides) {
  const Primitive& primitive = *part.primitive;
  std::vector<Vec3> corners(primitive.positions.size());
  std::vector<std::uint64_t> hashes(corners.size());
  parallel_each(corners.size(), 4096, [&](std::size_t i) {
    corners[i] = to_eye(view, to_world(part.world, primitive.positions[i]));
    hashes[i] = hash_of(corners[i]);
  });
  for (std::size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
    const std::uint32_t* index = &primitive.indices[t];
    const Vec3 &v0 = corners[index[0]], &v1 = corners[index[1]], &v2 = corners[index[2]];
    const double volume = glm::dot(v0, glm::cross(v1, v2)); // negative when the front is seen
    if (!is_finite(v0) || !is_finite(v1) || !is_finite(v2) || (volume > 0 && !part.look->double_sided)) continue;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = index[k], b = index[(k + 1) % 3];
      if (hashes[a] == hashes[b]) continue;
      sides.push_back({mix(hashes[a] + hashes[b]), part.look, volume < 0, corners[a], corners[b]});
    }
  }
}

/// Whether the sides [first, last) of one edge make it an outline.
bool is_outline(const Side* first, const Side* last) {
  if (last - first < 2) return true;
  return std::any_of(first + 1, last,
                     [&](const Side& side) { return side.front != first->front || side.look != first->look; });
}

struct End {
  Vec3 point;
  Vec3 direction = Vec3(0);
  Vec2 pixel = Vec2(0); ///< column and row, pixel (0, 0) covers [0, 1)^2
  bool inside = false;
};

/// Walks edges through one branch of the map and marks what they pass.
class Walker {
 public:
  Walker(const BranchMap& map, const Raster& raster, std::vector<std::uint8_t>& marks)
      : map_(map), raster_(raster), marks_(marks) {}

  void walk(const Vec3& a, const Vec3& b) const {
    if (glm::length(a) > 0 && glm::length(b) > 0) walk(end_at(a), end_at(b), 0);
  }

 private:
  const BranchMap& map_;
  const Raster& raster_;
  std::vector<std::uint8_t>& marks_;

  End end_at(const Vec3& point) const {
    End end{point};
    end.direction = glm::normalize(point);
    const Vec2 inside = map_.inside(point);
    end.inside = inside.x >= 0 && inside.y >= 0;
    if (!end.inside) return end;
    const Vec2 image = map_.image(point) / pixel_size(raster_);
    end.pixel = {image.x + 0.5 * raster_.width, 0.5 * raster_.height - image.y};
    return end;
  }

  bool is_short(const End& a, const End& b) const {
    const double chord = glm::distance(a.direction, b.direction);
    if (a.inside && b.inside) return chord < widest_angle && glm::distance(a.pixel, b.pixel) <= longest_step;
    return chord < longest_step * pixel_size(raster_);
  }

  void walk(const End& a, const End& b, int halvings) const {
    const Vec3 middle = 0.5 * (a.point + b.point);
    if (is_short(a, b) || halvings == most_halvings || !(glm::length(middle) > 0)) {
      if (a.inside) mark(a);
      if (b.inside) mark(b);
      return;
    }
    const End half = end_at(middle);
    walk(a, half, halvings + 1);
    walk(half, b, halvings + 1);
  }

  void mark(const End& end) const {
    const std::uint8_t level = level_of(glm::length(end.point));
    const auto clamped = [](double x, int n) { return static_cast<int>(std::clamp(std::floor(x), -1.0, double(n))); };
    const int left = std::max(clamped(end.pixel.x - half_width, raster_.width), 0);
    const int right = std::min(clamped(end.pixel.x + half_width, raster_.width), raster_.width - 1);
    const int top = std::max(clamped(end.pixel.y - half_width, raster_.height), 0);
    const int bottom = std::min(clamped(end.pixel.y + half_width, raster_.height), raster_.height - 1);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x)
        lower(marks_[std::size_t(y) * std::size_t(raster_.width) + std::size_t(x)], level);
  }

  static void lower(std::uint8_t& mark, std::uint8_t level) {
    const std::atomic_ref<std::uint8_t> shared(mark);
    std::uint8_t old = shared.load(std::memory_order_relaxed);
    while (level < old && !shared.compare_exchange_weak(old, level, std::memory_order_relaxed)) {
    }
  }
};

} // namespace

Outlines::Outlines(const Parts& parts, const View& view, const Surface& surface, const Raster& raster)
    : nearest_(std::size_t(raster.width) * std::size_t(raster.height), no_outline) {
  std::vector<Side> sides;
  for (const Part& part : parts.parts) append_sides(part, view, sides);
  tbb::parallel_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.key < b.key; });
  const ImageMap map = make_image_map(surface, Method::automatic);
  parallel_each(sides.size(), 256, [&](std::size_t i) {
    if (i > 0 && sides[i - 1].key == sides[i].key) return;
    const Side *first = &sides[i], *last = first + 1, *end = sides.data() + sides.size();
    while (last != end && last->key == first->key) ++last;
    if (!is_outline(first, last)) return;
    for (const BranchMap& branch : map.branches) Walker(branch, raster, nearest_).walk(first->a, first->b);
  });
}

bool Outlines::crosses(std::size_t pixel, double depth) const {
  return nearest_[pixel] != no_outline && nearest_[pixel] <= level_of(depth);
}

} // namespace domewarp
