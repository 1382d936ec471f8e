// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/simulate.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/render/sampling.h"
#include "domewarp/render/shading.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

struct DisplayedPicture::Impl {
  const Surface& surface;
  Raster raster;
  ImageMap map;
  double hidden_from;

  /// The image point of what the eye sees in a direction: the nearest point of the surface.
  std::optional<Vec2> image(const Vec3& direction) const {
    const bool is_simple = map.branches.size() == 1 && std::isinf(hidden_from);
    std::optional<Vec2> found;
    Vec2 on_curve(0);
    for (const BranchMap& branch : map.branches) {
      const Vec2 inside = branch.inside(direction);
      if (inside.x < 0 || inside.y < 0) continue;
      const Vec2 at = branch.image(direction);
      if (is_simple) return at;
      const std::optional<Vec2> here = surface.meridian(glm::length(at));
      if (!here || (found && glm::length(*here) >= glm::length(on_curve))) continue;
      on_curve = *here;
      found = at;
    }
    return on_curve.x < hidden_from ? found : std::nullopt;
  }
};

DisplayedPicture::DisplayedPicture(const Surface& surface, const Raster& raster)
    : impl_(new Impl{surface, raster, make_image_map(surface, Method::automatic), surface.hidden_from()}) {}
DisplayedPicture::~DisplayedPicture() = default;

std::optional<Vec2> DisplayedPicture::pixel(const Vec3& direction) const {
  const std::optional<Vec2> at = impl_->image(direction);
  if (!at) return std::nullopt;
  const Raster& raster = impl_->raster;
  return Vec2(0.5 * raster.width + at->x / pixel_size(raster), 0.5 * raster.height - at->y / pixel_size(raster));
}

std::optional<Vec2> DisplayedPicture::pixel_inside(const Vec3& direction) const {
  const std::optional<Vec2> at = pixel(direction);
  const Raster& raster = impl_->raster;
  const bool inside = at && at->x >= 0 && at->y >= 0 && at->x <= raster.width && at->y <= raster.height;
  return inside ? at : std::nullopt;
}

std::optional<Vec3> DisplayedPicture::point(const Vec3& direction) const {
  const std::optional<Vec2> at = impl_->image(direction);
  if (!at) return std::nullopt;
  const std::optional<Vec2> on_curve = impl_->surface.meridian(glm::length(*at));
  if (!on_curve) return std::nullopt;
  return glm::normalize(direction) * glm::length(*on_curve);
}

namespace {

void check(const EyeCamera& camera) {
  if (!(camera.fov_deg > 0 && camera.fov_deg < 180))
    throw Error(ErrorCode::usage, "--view-fov: must be between 0 and 180 degrees, got " + std::to_string(camera.fov_deg));
  const double length = glm::length(camera.look);
  if (!(length > 0) || !std::isfinite(length))
    throw Error(ErrorCode::usage, "--look: needs a direction that is finite and not zero");
}

/// Half the height of the view at distance 1.
double half_height(const EyeCamera& camera) { return std::tan(camera.fov_deg * std::numbers::pi / 360); }

/// The camera's axes in eye space.
View axes(const EyeCamera& camera) {
  const Vec3 back = -glm::normalize(camera.look);
  const bool vertical = std::abs(back.y) > 0.999999;
  const Vec3 right = glm::normalize(glm::cross(vertical ? Vec3(0, 0, back.y > 0 ? -1 : 1) : Vec3(0, 1, 0), back));
  return {Vec3(0), right, glm::cross(back, right), back};
}

Vec3 through(const EyeCamera& camera, const View& axes, double column, double row) {
  const double scale = half_height(camera) * pixel_size(camera.raster);
  return (column - 0.5 * camera.raster.width) * scale * axes.right +
         (0.5 * camera.raster.height - row) * scale * axes.up - axes.back;
}

/// A picture in linear light.
class LinearPicture {
 public:
  explicit LinearPicture(const Pixels& pixels) : pixels_(pixels) {}

  /// Light multiplied by alpha, and alpha; none outside the picture.
  Vec4 texel(int column, int row) const {
    if (column < 0 || row < 0 || column >= pixels_.width || row >= pixels_.height) return Vec4(0);
    const std::size_t i = std::size_t(row) * std::size_t(pixels_.width) + std::size_t(column);
    const std::uint8_t* p = &pixels_.rgba[4 * i];
    const double alpha = p[3] / 255.0;
    return {linear_of_srgb(p[0]) * alpha, linear_of_srgb(p[1]) * alpha, linear_of_srgb(p[2]) * alpha, alpha};
  }

  Vec4 at(const Vec2& pixel, PictureFilter filter) const {
    if (!(pixel.x > -1 && pixel.y > -1 && pixel.x < pixels_.width + 1.0 && pixel.y < pixels_.height + 1.0)) return Vec4(0);
    if (filter == PictureFilter::nearest)
      return texel(static_cast<int>(std::floor(pixel.x)), static_cast<int>(std::floor(pixel.y)));
    const Vec2 corner(std::floor(pixel.x - 0.5), std::floor(pixel.y - 0.5)), t = pixel - 0.5 - corner;
    const int x = static_cast<int>(corner.x), y = static_cast<int>(corner.y);
    return (1 - t.y) * ((1 - t.x) * texel(x, y) + t.x * texel(x + 1, y)) +
           t.y * ((1 - t.x) * texel(x, y + 1) + t.x * texel(x + 1, y + 1));
  }

 private:
  const Pixels& pixels_;
};

} // namespace

Vec3 direction_through(const EyeCamera& camera, double column, double row) {
  return through(camera, axes(camera), column, row);
}

Pixels simulate(const Pixels& picture, const Surface& surface, const EyeCamera& camera, const SimulateOptions& options) {
  check(camera);
  if (options.samples < 1 || options.samples > 4096)
    throw Error(ErrorCode::usage, "--samples: must be from 1 to 4096, got " + std::to_string(options.samples));
  const DisplayedPicture displayed(surface, {picture.width, picture.height});
  const LinearPicture light(picture);
  const View camera_axes = axes(camera);
  const int width = camera.raster.width, height = camera.raster.height;
  Pixels view{width, height, std::vector<std::uint8_t>(4 * std::size_t(width) * std::size_t(height))};
  parallel_each(std::size_t(height), 4, [&](std::size_t line) {
    const int row = static_cast<int>(line);
    for (int column = 0; column < width; ++column) {
      Vec4 sum(0);
      for (int i = 0; i < options.samples; ++i) {
        const Vec2 offset = options.samples == 1 ? Vec2(0.5) : sobol_point(static_cast<std::uint32_t>(i), pixel_seed(column, row));
        const auto at = displayed.pixel(through(camera, camera_axes, column + offset.x, row + offset.y));
        if (at) sum += light.at(*at, options.filter);
      }
      const auto colour = resolve_pixel(sum / double(options.samples), {0, 0, 0, 0});
      std::copy(colour.begin(), colour.end(), &view.rgba[4 * (line * std::size_t(width) + std::size_t(column))]);
    }
  });
  return view;
}

View turn_view(const View& view, const EyeCamera& camera) {
  check(camera);
  const View local = axes(camera);
  const auto to_world = [&view](const Vec3& v) { return v.x * view.right + v.y * view.up + v.z * view.back; };
  return {view.eye, to_world(local.right), to_world(local.up), to_world(local.back)};
}

Surface flat_surface(const EyeCamera& camera) {
  check(camera);
  SurfaceOptions options;
  std::array<char, 32> text{};
  options.curve.assign(text.data(), std::to_chars(text.data(), text.data() + text.size(), 1 / half_height(camera), std::chars_format::fixed, 17).ptr);
  return Surface(options, screen_radius(camera.raster));
}

} // namespace domewarp
