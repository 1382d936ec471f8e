// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/ray_trace.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/render/bands.h"
#include "domewarp/render/outlines.h"
#include "domewarp/render/parts.h"
#include "domewarp/render/ray_geometry.h"
#include "domewarp/render/ray_shade.h"
#include "domewarp/render/sampling.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

namespace {

constexpr int tile_size = 32;
constexpr std::size_t packet_size = RayGeometry::packet_size;
constexpr int packet_side = 4; ///< pixels that are traced together: a square goes the same way better than a row
static_assert(packet_side * packet_side == packet_size);
constexpr int most_samples = 4096;

struct Job {
  const Surface& surface;
  const Raster& raster;
  const RayTraceOptions& options;
  const RayWorld& world;
  const Outlines* outlines; ///< null when they are not asked for
};

/// What decides whether a pixel needs more samples.
struct Contrast {
  float lightness = 0, alpha = 0;
  float depth = std::numeric_limits<float>::infinity();
};

/// A band of the picture with a row above and below, where they exist.
struct Band {
  Frame& frame;
  int top;                      ///< of the frame, in the picture
  int first, last;              ///< rows that are traced: [first, last)
  std::vector<Contrast> around; ///< of all of them; empty with one sample per pixel
};

void store_colour(const Job& job, Frame& frame, std::size_t pixel, const Vec4& light) {
  const auto colour = resolve_pixel(light, job.options.background);
  std::copy(colour.begin(), colour.end(), &frame.rgba[4 * pixel]);
  if (!frame.light.empty()) frame.light[pixel] = Vec4f(over_background(light, job.options.background));
}

void store_hit(const Job& job, Frame& frame, std::size_t pixel, const RayHit& hit) {
  if (!hit.part || frame.object.empty()) return;
  frame.object[pixel] = hit.part->object;
  frame.triangle[pixel] = hit.part->first_triangle + hit.triangle + 1;
  const SurfacePoint point = surface_point(job.world, hit);
  frame.position[pixel] = Vec3f(point.position);
  frame.depth[pixel] = static_cast<float>(glm::length(point.position));
  if (frame.normal.empty()) return;
  frame.normal[pixel] = Vec3f(seen_normal(point));
  frame.uv[pixel] = Vec2f(point.base_uv);
}

Contrast contrast_of(const Job& job, const RaySample& sample) {
  Contrast contrast{static_cast<float>(lightness(Vec3(sample.light))), static_cast<float>(sample.light.a)};
  if (sample.first.part)
    contrast.depth = static_cast<float>(glm::length(surface_point(job.world, sample.first).position));
  return contrast;
}

std::uint16_t ray_count(unsigned rays) {
  return static_cast<std::uint16_t>(std::min(rays, 65535u));
}

/// A packet of neighbouring pixels, each through its centre.
void trace_centres(const Job& job, Band& band, int left, int right, int top, int bottom) {
  Vec3 directions[packet_size];
  RaySample samples[packet_size];
  std::array<int, 2> pixels[packet_size]; // column, row
  std::size_t count = 0;
  const std::size_t width = std::size_t(job.raster.width);
  const auto is_kept = [&](int row) { return row >= band.top && row < band.top + band.frame.height; };
  const auto index = [&](int column, int row, int first) { return std::size_t(row - first) * width + std::size_t(column); };
  for (int row = top; row < bottom; ++row)
    for (int column = left; column < right; ++column)
      if (unproject(job.surface, pixel_centre(job.raster, column, row), directions[count]))
        pixels[count++] = {column, row};
      else if (is_kept(row))
        store_colour(job, band.frame, index(column, row, band.top), Vec4(0));
  trace(job.world, {directions, count}, samples);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [column, row] = pixels[i];
    if (!band.around.empty()) band.around[index(column, row, band.first)] = contrast_of(job, samples[i]);
    if (!is_kept(row)) continue;
    const std::size_t pixel = index(column, row, band.top);
    store_colour(job, band.frame, pixel, samples[i].light);
    store_hit(job, band.frame, pixel, samples[i].first);
    if (job.options.count_rays) band.frame.rays[pixel] = ray_count(samples[i].rays);
  }
}

/// What the 3 x 3 pixels around one span.
struct Range {
  float lightness[2] = {2, -1}, alpha[2] = {2, -1};
  float depth = 0;

  void add(const Contrast& c) {
    lightness[0] = std::min(lightness[0], c.lightness), lightness[1] = std::max(lightness[1], c.lightness);
    alpha[0] = std::min(alpha[0], c.alpha), alpha[1] = std::max(alpha[1], c.alpha);
    depth = std::max(depth, c.depth);
  }
};

bool needs_samples(const Job& job, const Band& band, int column, int row) {
  Range range;
  for (int y = std::max(row - 1, band.first); y <= std::min(row + 1, band.last - 1); ++y)
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, job.raster.width - 1); ++x)
      range.add(band.around[std::size_t(y - band.first) * std::size_t(job.raster.width) + std::size_t(x)]);
  if (range.lightness[1] - range.lightness[0] > job.options.contrast) return true;
  if (range.alpha[1] - range.alpha[0] > job.options.contrast) return true;
  const std::size_t pixel = std::size_t(row) * std::size_t(job.raster.width) + std::size_t(column);
  return job.outlines && job.outlines->crosses(pixel, range.depth);
}

/// Replaces a pixel's colour by the mean of many samples.
void sample_pixel(const Job& job, Band& band, int column, int row) {
  const std::uint32_t seed = pixel_seed(column, row);
  Vec4 sum(0);
  unsigned rays = 1; // the one through the centre
  for (int done = 0; done < job.options.samples;) {
    const int block = std::min(job.options.samples - done, static_cast<int>(packet_size));
    Vec3 directions[packet_size];
    std::size_t count = 0;
    for (int i = 0; i < block; ++i) {
      const Vec2 at = sobol_point(static_cast<std::uint32_t>(done + i), seed) - 0.5;
      if (unproject(job.surface, pixel_centre(job.raster, column + at.x, row + at.y), directions[count])) ++count;
    }
    RaySample samples[packet_size];
    trace(job.world, {directions, count}, samples);
    for (std::size_t i = 0; i < count; ++i) sum += samples[i].light, rays += samples[i].rays;
    done += block;
  }
  const std::size_t pixel = std::size_t(row - band.top) * std::size_t(job.raster.width) + std::size_t(column);
  store_colour(job, band.frame, pixel, sum / double(job.options.samples));
  if (job.options.count_rays) band.frame.rays[pixel] = ray_count(rays);
}

/// Calls visit(left, right, top, bottom) for every tile of some rows, in parallel, and tells how far it got.
template <typename Visit>
void for_each_tile(const Job& job, const char* stage, int first, int last, Visit&& visit) {
  const int width = job.raster.width;
  const int across = (width + tile_size - 1) / tile_size, down = (last - first + tile_size - 1) / tile_size;
  std::atomic<int> rows_done = 0;
  parallel_each(std::size_t(down), 1, [&](std::size_t j) {
    const int top = first + static_cast<int>(j) * tile_size, bottom = std::min(top + tile_size, last);
    parallel_each(std::size_t(across), 1, [&](std::size_t i) {
      const int left = static_cast<int>(i) * tile_size;
      visit(left, std::min(left + tile_size, width), top, bottom);
    });
    const int done = rows_done += bottom - top;
    tell(job.options.progress, stage, double(first + done) / job.raster.height);
  });
}

void trace_band(const Job& job, Band& band) {
  for_each_tile(job, "trace", band.first, band.last, [&](int left, int right, int top, int bottom) {
    for (int row = top; row < bottom; row += packet_side)
      for (int column = left; column < right; column += packet_side)
        trace_centres(job, band, column, std::min(column + packet_side, right), row, std::min(row + packet_side, bottom));
  });
  if (job.options.samples == 1) return;
  const int bottom_row = band.top + band.frame.height;
  for_each_tile(job, "sample", band.top, bottom_row, [&](int left, int right, int top, int bottom) {
    for (int row = top; row < bottom; ++row)
      for (int column = left; column < right; ++column)
        if (needs_samples(job, band, column, row)) sample_pixel(job, band, column, row);
  });
}

void check(const RayTraceOptions& options, const Scene& scene) {
  if (options.samples < 1 || options.samples > most_samples)
    throw Error(ErrorCode::usage, "--samples: must be from 1 to " + std::to_string(most_samples) + ", got " +
                                      std::to_string(options.samples));
  if (options.lights && scene.lights.empty())
    throw Error(ErrorCode::input, "scene: has no lights (KHR_lights_punctual) to light it with");
}

/// Traces the picture in bands of `rows` and hands on every one.
void trace_bands(const Scene& scene, const View& view, const Surface& surface, const Raster& raster,
                 const RayTraceOptions& options, int rows, const std::function<void(Frame&&, int)>& hand_on) {
  check(options, scene);
  const Parts parts = prepare_parts(scene);
  const RayGeometry geometry(parts, view, options.embree);
  const std::vector<PlacedLight> lights = place_lights(scene, world_to_eye(view));
  const Lighting lighting{options.unlit, options.lights ? &lights : nullptr, std::exp2(options.exposure)};
  const RayWorld world{view, geometry, lighting, options.shadows, options.near};
  std::optional<Outlines> outlines;
  if (options.samples > 1 && options.outlines) outlines.emplace(parts, view, surface, raster);
  const Job job{surface, raster, options, world, outlines ? &*outlines : nullptr};
  for (int top = 0; top < raster.height; top += rows) {
    Frame frame = make_frame(raster.width, std::min(rows, raster.height - top), options.layers);
    frame.renderer = "Embree";
    frame.warnings = parts.warnings;
    const int halo = options.samples > 1 ? 1 : 0;
    Band band{frame, top, std::max(top - halo, 0), std::min(top + frame.height + halo, raster.height), {}};
    const std::size_t width = std::size_t(raster.width);
    if (halo) band.around.resize(std::size_t(band.last - band.first) * width);
    if (options.count_rays) frame.rays.assign(std::size_t(frame.height) * width, 0);
    trace_band(job, band);
    hand_on(std::move(frame), top);
  }
}

} // namespace

Frame ray_trace(const Scene& scene, const View& view, const Surface& surface, const Raster& raster,
                const RayTraceOptions& options) {
  Frame whole = make_frame(raster.width, raster.height, Layers::colours);
  trace_bands(scene, view, surface, raster, options, raster.height, [&](Frame&& frame, int) { whole = std::move(frame); });
  return whole;
}

void ray_trace(const Scene& scene, const View& view, const Surface& surface, const Raster& raster,
               const RayTraceOptions& options, const FrameSink& sink) {
  trace_bands(scene, view, surface, raster, options, band_height(raster),
              [&](Frame&& frame, int top) { sink(frame, top); });
}

} // namespace domewarp
