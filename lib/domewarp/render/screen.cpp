// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/screen.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/scene/view.h"

namespace domewarp {

namespace {

/// From world positions to the screen.
struct Lens {
  Mat4 camera_from_world;
  bool perspective;
  double half_height; ///< of the picture, at distance 1 or anywhere
  Raster raster;
};

Lens lens_of(const Scene& scene, const Raster& raster) {
  if (scene.cameras.empty()) throw Error(ErrorCode::input, "scene: has no camera to draw through");
  const Camera& camera = scene.cameras.front();
  return {glm::inverse(camera.world), camera.perspective,
          camera.perspective ? std::tan(camera.yfov / 2) : camera.ymag, raster};
}

/// @return false for a point that is not in front of the eye
bool project(const Lens& lens, const Vec3& world, ScreenCorner& corner) {
  const Vec3 p(lens.camera_from_world * Vec4(world, 1));
  const double w = lens.perspective ? -p.z : 1;
  if (!(w > 0) || !std::isfinite(w)) return false;
  corner.weight = 1 / w;
  const double scale = 0.5 * lens.raster.height / lens.half_height / w;
  corner.pixel = {0.5 * lens.raster.width + p.x * scale, 0.5 * lens.raster.height - p.y * scale};
  return std::isfinite(corner.pixel.x) && std::isfinite(corner.pixel.y);
}

void add_primitive(const Lens& lens, const Instance& instance, const Primitive& primitive, std::uint32_t object,
                   std::uint32_t number, bool opaque, Screen& screen) {
  const Attribute* source = find_attribute(primitive, "_SOURCE_POSITION");
  const bool has_source = source && source->components == 3 && source->values.size() == 3 * primitive.positions.size();
  screen.has_source = screen.has_source && has_source;
  for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3, ++number) {
    ScreenTriangle triangle;
    triangle.object = object;
    triangle.triangle = number;
    triangle.opaque = opaque;
    bool in_front = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t vertex = primitive.indices[i + k];
      const Vec3 world = to_world(instance.world, primitive.positions[vertex]);
      in_front = in_front && project(lens, world, triangle.corners[k]);
      if (has_source) {
        const float* values = &source->values[3 * vertex];
        triangle.corners[k].source = {values[0], values[1], values[2]};
      }
    }
    if (in_front) screen.triangles.push_back(triangle);
  }
}

} // namespace

Screen make_screen(const Scene& scene, const Raster& raster) {
  const Lens lens = lens_of(scene, raster);
  Screen screen;
  screen.has_source = true;
  screen.perspective = lens.perspective;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    screen.first.push_back(screen.triangles.size());
    std::uint32_t number = 0;
    for (const Primitive& primitive : scene.meshes[std::size_t(scene.instances[i].mesh)].primitives) {
      if (primitive.topology != Topology::triangles) continue;
      const bool opaque =
          primitive.material < 0 || scene.materials[std::size_t(primitive.material)].alpha_mode == AlphaMode::opaque;
      add_primitive(lens, scene.instances[i], primitive, static_cast<std::uint32_t>(i + 1), number, opaque, screen);
      number += static_cast<std::uint32_t>(primitive.indices.size() / 3);
    }
  }
  screen.first.push_back(screen.triangles.size());
  return screen;
}

const ScreenTriangle* find_triangle(const Screen& screen, std::uint32_t object, std::uint32_t triangle) {
  if (object == 0 || object >= screen.first.size()) return nullptr;
  const auto begin = screen.triangles.begin() + static_cast<std::ptrdiff_t>(screen.first[object - 1]);
  const auto end = screen.triangles.begin() + static_cast<std::ptrdiff_t>(screen.first[object]);
  const auto at = std::lower_bound(begin, end, triangle,
                                   [](const ScreenTriangle& t, std::uint32_t number) { return t.triangle < number; });
  return at != end && at->triangle == triangle ? &*at : nullptr;
}

namespace {

using GridPoint = std::array<std::int64_t, 2>;

/// Twice the signed area of (a, b, p) in grid steps, positive when p is to the right of a -> b on the screen.
std::int64_t side(const GridPoint& a, const GridPoint& b, const GridPoint& p) {
  return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

/// Whether points exactly on the edge a -> b belong to the triangle on its right.
bool is_top_left(const GridPoint& a, const GridPoint& b) { return b[1] < a[1] || (b[1] == a[1] && b[0] > a[0]); }

/// A triangle on the grid, clockwise on the screen.
struct GridTriangle {
  std::int64_t steps = 256; ///< of the rasteriser's grid, per pixel
  GridPoint corners[3];
  int order[3] = {0, 1, 2}; ///< of the corners in the ScreenTriangle
  std::int64_t area = 0;
};

/// @return false for one without area or farther out than the grid reaches
bool snap(const ScreenTriangle& triangle, std::int64_t steps, GridTriangle& grid) {
  constexpr double farthest = 1 << 20;
  grid.steps = steps;
  for (int k = 0; k < 3; ++k) {
    const Vec2& p = triangle.corners[k].pixel;
    if (!(std::abs(p.x) < farthest && std::abs(p.y) < farthest)) return false;
    grid.corners[k] = {std::llround(p.x * double(steps)), std::llround(p.y * double(steps))};
  }
  grid.area = side(grid.corners[0], grid.corners[1], grid.corners[2]);
  if (grid.area < 0) {
    std::swap(grid.corners[1], grid.corners[2]);
    std::swap(grid.order[1], grid.order[2]);
    grid.area = -grid.area;
  }
  return grid.area > 0;
}

/// @param weights corners' shares at the pixel's centre
bool covers(const GridTriangle& grid, int column, int row, double (&weights)[3]) {
  const GridPoint p = {column * grid.steps + grid.steps / 2, row * grid.steps + grid.steps / 2};
  for (int k = 0; k < 3; ++k) {
    const GridPoint& a = grid.corners[(k + 1) % 3];
    const GridPoint& b = grid.corners[(k + 2) % 3];
    const std::int64_t value = side(a, b, p);
    if (value < 0 || (value == 0 && !is_top_left(a, b))) return false;
    weights[grid.order[k]] = static_cast<double>(value) / static_cast<double>(grid.area);
  }
  return true;
}

Vec3 source_at(const ScreenTriangle& triangle, const double (&weights)[3]) {
  Vec3 sum(0);
  double total = 0;
  for (int k = 0; k < 3; ++k) {
    const double share = weights[k] * triangle.corners[k].weight;
    sum += share * triangle.corners[k].source;
    total += share;
  }
  return sum / total;
}

/// First and last pixel whose centres lie between the three coordinates and inside [first, last].
std::array<int, 2> pixel_range(const GridTriangle& grid, std::size_t axis, int first, int last) {
  const auto [low, high] = std::minmax({grid.corners[0][axis], grid.corners[1][axis], grid.corners[2][axis]});
  const auto pixel = [steps = grid.steps](std::int64_t at) { return at >= 0 ? at / steps : -((-at + steps - 1) / steps); };
  return {static_cast<int>(std::max<std::int64_t>(pixel(low), first)),
          static_cast<int>(std::min<std::int64_t>(pixel(high), last))};
}

/// A triangle without area in the scene closes the gap between the drawn courses of its long side and its two short ones:
/// it covers what its neighbours cover. Judged by its source positions, which are float32.
bool has_area(const ScreenTriangle& triangle) {
  const Vec3 &a = triangle.corners[0].source, &b = triangle.corners[1].source, &c = triangle.corners[2].source;
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  double farthest = 0;
  for (const ScreenCorner& corner : triangle.corners)
    farthest = std::max({farthest, std::abs(corner.source.x), std::abs(corner.source.y), std::abs(corner.source.z)});
  constexpr double rounding = 4 * 6e-8; // of corners that lie up to three roundings off their line
  return glm::length(glm::cross(b - a, c - a)) > rounding * farthest * longest;
}

void count_triangle(const ScreenTriangle& triangle, const Frame& frame, double depth_bound, int top, int bottom,
                    std::vector<std::uint8_t>& covers_of) {
  const auto [low, high] = std::minmax(
      {triangle.corners[0].pixel.y, triangle.corners[1].pixel.y, triangle.corners[2].pixel.y});
  GridTriangle grid;
  if (!triangle.opaque || high < top || low > bottom || !has_area(triangle) || !snap(triangle, std::int64_t{1} << (frame.subpixel_bits >= 1 ? frame.subpixel_bits : 8), grid)) return;
  const auto [first_row, last_row] = pixel_range(grid, 1, top, bottom - 1);
  const auto [first, last] = pixel_range(grid, 0, 0, frame.width - 1);
  double weights[3];
  for (int row = first_row; row <= last_row; ++row)
    for (int column = first; column <= last; ++column) {
      const std::size_t i = std::size_t(row) * std::size_t(frame.width) + std::size_t(column);
      if (frame.object[i] != triangle.object || !covers(grid, column, row, weights)) continue;
      const double distance = glm::length(source_at(triangle, weights)), seen = frame.depth[i];
      if (std::abs(distance - seen) <= depth_bound * seen) covers_of[i] += covers_of[i] < 255;
    }
}

} // namespace

std::vector<std::uint8_t> count_covers(const Screen& screen, const Frame& frame, double depth_bound) {
  std::vector<std::uint8_t> counts(frame.object.size(), 0);
  constexpr int band = 64;
  parallel_each(std::size_t((frame.height + band - 1) / band), 1, [&](std::size_t i) {
    const int top = static_cast<int>(i) * band, bottom = std::min(top + band, frame.height);
    for (const ScreenTriangle& triangle : screen.triangles)
      count_triangle(triangle, frame, depth_bound, top, bottom, counts);
  });
  return counts;
}

} // namespace domewarp
