// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/rasterise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/render/bands.h"
#include "domewarp/render/gl_context.h"
#include "domewarp/render/gl_draw.h"
#include "domewarp/render/gl_geometry.h"
#include "domewarp/render/parts.h"
#include "domewarp/render/shading.h"

namespace domewarp {

namespace {

constexpr int most_supersamples = 16;
constexpr int largest_target = 4096; ///< samples across: 16 million of 20 to 64 bytes each

[[noreturn]] void refuse_camera(const Camera& camera, const std::string& reason) {
  throw Error(ErrorCode::input, "camera " + (camera.name.empty() ? std::string("0") : camera.name) + ": " + reason);
}

const Camera& checked_camera(const Scene& scene, std::size_t index) {
  if (index >= scene.cameras.size()) throw Error(ErrorCode::input, "scene: has no camera to draw through");
  const Camera& camera = scene.cameras[index];
  const double determinant = glm::determinant(camera.world);
  if (!(std::abs(determinant) > 0) || !std::isfinite(determinant))
    refuse_camera(camera, "its matrix cannot be inverted");
  if (camera.perspective && !(camera.yfov > 0 && camera.yfov < std::numbers::pi))
    refuse_camera(camera, "yfov must lie between 0 and pi, got " + std::to_string(camera.yfov));
  if (!camera.perspective && !(camera.ymag > 0 && std::isfinite(camera.ymag)))
    refuse_camera(camera, "ymag must be positive, got " + std::to_string(camera.ymag));
  const bool infinite = camera.perspective && camera.zfar == 0;
  if (!(camera.perspective ? camera.znear > 0 : camera.znear >= 0) || !(infinite || camera.zfar > camera.znear))
    refuse_camera(camera, "znear " + std::to_string(camera.znear) + " and zfar " + std::to_string(camera.zfar) +
                              " enclose nothing");
  return camera;
}

/// Depth rows (z coefficient, constant) of the projection: 1 at the near plane, 0 at the far one. The 1e-6 keeps a
/// vertex that lies on a plane exactly from being lost to rounding.
Vec2 depth_row(const Camera& camera) {
  const double near = camera.znear * (1 - 1e-6), far = camera.zfar * (1 + 1e-6);
  if (!camera.perspective) return {1 / (far - near), far / (far - near)};
  if (camera.zfar == 0) return {0, near};
  return {near / (far - near), near * far / (far - near)};
}

/// Camera space to the clip space of the picture.
glm::mat4 projection_of(const Camera& camera, const Raster& raster) {
  const double half_height = camera.perspective ? std::tan(camera.yfov / 2) : camera.ymag;
  const Vec2 depth = depth_row(camera);
  Mat4 m(0);
  m[0][0] = 1 / (half_height * aspect(raster));
  m[1][1] = 1 / half_height;
  m[camera.perspective ? 2 : 3][3] = camera.perspective ? -1 : 1;
  m[2][2] += depth.x;
  m[3][2] += depth.y;
  return glm::mat4(m);
}

/// What is drawn, and the device's room for one tile of it.
struct Job {
  const Raster& raster;
  const RasterOptions& options;
  const GlDrawing& drawing;
  glm::mat4 projection;
  int tile_width, tile_height; ///< pixels
  GlTarget& colours;           ///< of supersample^2 samples per pixel
  GlTarget* centres;           ///< the other layers, when they are another picture than the colours
};

void store_colour(Frame& frame, std::size_t pixel, const Vec4& light, const RasterOptions& options) {
  const auto colour = resolve_pixel(light, options.background);
  std::copy(colour.begin(), colour.end(), &frame.rgba[4 * pixel]);
  if (!frame.light.empty()) frame.light[pixel] = Vec4f(over_background(light, options.background));
}

void store_layers(Frame& frame, std::size_t pixel, const GlTarget& data, std::size_t i) {
  frame.object[pixel] = data.ids[i].object;
  frame.triangle[pixel] = data.ids[i].triangle;
  if (!data.ids[i].object) return;
  if (data.source[i].w > 0) {
    frame.position[pixel] = Vec3f(data.source[i]);
    frame.drawn_depth[pixel] = data.source[i].w;
    frame.depth[pixel] = static_cast<float>(glm::length(Vec3(data.source[i])));
  }
  if (frame.normal.empty()) return;
  frame.normal[pixel] = Vec3f(data.normal[i]);
  frame.uv[pixel] = data.uv[i];
}

/// Calls store(pixel of the frame, column and row in the tile, from below) for all of a tile, in parallel.
template <typename Store>
void for_each_pixel(const Frame& frame, int top, const Tile& tile, Store&& store) {
  parallel_each(std::size_t(tile.height), 16, [&](std::size_t row) {
    const std::size_t from_below = std::size_t(tile.height) - 1 - row;
    const std::size_t first = (std::size_t(tile.top - top) + row) * std::size_t(frame.width) + std::size_t(tile.left);
    for (std::size_t i = 0; i < std::size_t(tile.width); ++i) store(first + i, i, from_below);
  });
}

/// Mean of the samples of one pixel.
Vec4 mean(const std::vector<Vec4f>& colour, std::size_t stride, std::size_t column, std::size_t row, int supersample) {
  const std::size_t n = std::size_t(supersample);
  Vec4 sum(0);
  for (std::size_t y = row * n; y < (row + 1) * n; ++y)
    for (std::size_t x = column * n; x < (column + 1) * n; ++x) sum += Vec4(colour[y * stride + x]);
  return sum / double(n * n);
}

/// Draws a tile into a frame whose first row is row `top` of the picture.
void draw_tile(const Job& job, const Tile& tile, Frame& frame, int top) {
  const int n = job.options.supersample;
  const auto draw = [&](GlTarget& target, int scale) {
    target.bind();
    target.clear();
    job.drawing.draw(job.projection, scale * job.raster.width, scale * job.raster.height,
                     {scale * tile.left, scale * tile.top, scale * tile.width, scale * tile.height});
    target.read(scale * tile.width, scale * tile.height);
  };
  draw(job.colours, n);
  const std::size_t stride = std::size_t(n) * std::size_t(tile.width), width = std::size_t(tile.width);
  for_each_pixel(frame, top, tile, [&](std::size_t pixel, std::size_t x, std::size_t y) {
    store_colour(frame, pixel, mean(job.colours.colour, stride, x, y, n), job.options);
  });
  if (frame.object.empty()) return;
  if (job.centres) draw(*job.centres, 1);
  const GlTarget& layers = job.centres ? *job.centres : job.colours;
  for_each_pixel(frame, top, tile, [&](std::size_t pixel, std::size_t x, std::size_t y) {
    store_layers(frame, pixel, layers, y * width + x);
  });
}

/// Fills a frame whose first row is row `top` of the picture.
void draw_rows(const Job& job, Frame& frame, int top) {
  for (int y = top; y < top + frame.height; y += job.tile_height) {
    const int height = std::min(job.tile_height, top + frame.height - y);
    for (int x = 0; x < frame.width; x += job.tile_width)
      draw_tile(job, {x, y, std::min(job.tile_width, frame.width - x), height}, frame, top);
    tell(job.options.progress, "draw", double(y + height) / job.raster.height);
  }
}

void check(const Raster& raster, const RasterOptions& options) {
  if (options.supersample < 1 || options.supersample > most_supersamples)
    throw Error(ErrorCode::usage, "--supersample: must be from 1 to " + std::to_string(most_supersamples) + ", got " +
                                      std::to_string(options.supersample));
  if (raster.width < 1 || raster.height < 1)
    throw Error(ErrorCode::usage, "--size " + std::to_string(raster.width) + "x" + std::to_string(raster.height) +
                                      ": needs positive sizes");
}

/// Draws the picture at once or in bands, and hands on every one. The tiles are the same ones in any case.
void draw_bands(const Scene& scene, const Raster& raster, const RasterOptions& options, bool at_once,
                const std::function<void(Frame&&, int)>& hand_on) {
  check(raster, options);
  const Camera& camera = checked_camera(scene, options.camera);
  const Parts parts = prepare_parts(scene);
  const GlGeometry geometry = make_gl_geometry(parts, glm::inverse(camera.world));
  const GlContext context;
  const GlScenery scenery{options.unlit, options.lights ? &*options.lights : nullptr, std::exp2(options.exposure),
                          !camera.perspective, glm::determinant(camera.world) < 0};
  const GlDrawing drawing(parts, geometry, scenery);
  const int n = options.supersample;
  const int size = std::clamp(options.tile, 1, std::min(largest_tile(), largest_target) / n);
  const int width = std::min(size, raster.width), height = std::min({size, raster.height, band_height(raster)});
  const int rows = at_once ? raster.height : band_height(raster) / height * height;
  const bool two_pictures = n > 1 && options.layers != Layers::colours;
  GlTarget colours(n * width, n * height, two_pictures ? Layers::colours : options.layers);
  std::unique_ptr<GlTarget> centres;
  if (two_pictures) centres = std::make_unique<GlTarget>(width, height, options.layers);
  const Job job{raster, options, drawing, projection_of(camera, raster), width, height, colours, centres.get()};
  for (int top = 0; top < raster.height; top += rows) {
    Frame frame = make_frame(raster.width, std::min(rows, raster.height - top), options.layers);
    if (options.layers != Layers::colours)
      frame.drawn_depth.assign(frame.object.size(), std::numeric_limits<float>::quiet_NaN());
    frame.renderer = context.driver();
    frame.subpixel_bits = subpixel_bits();
    frame.warnings = parts.warnings;
    draw_rows(job, frame, top);
    hand_on(std::move(frame), top);
  }
}

} // namespace

Frame rasterise(const Scene& scene, const Raster& raster, const RasterOptions& options) {
  Frame whole = make_frame(raster.width, raster.height, Layers::colours);
  draw_bands(scene, raster, options, true, [&](Frame&& frame, int) { whole = std::move(frame); });
  return whole;
}

void rasterise(const Scene& scene, const Raster& raster, const RasterOptions& options, const FrameSink& sink) {
  draw_bands(scene, raster, options, false, [&](Frame&& frame, int top) { sink(frame, top); });
}

} // namespace domewarp
