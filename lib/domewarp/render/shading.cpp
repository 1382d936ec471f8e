// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/shading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace domewarp {

namespace {

/// Linear light of (i + shift) / 255 for every i.
std::array<double, 256> make_srgb_table(double shift) {
  std::array<double, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double s = (static_cast<double>(i) + shift) / 255;
    table[i] = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  }
  return table;
}

/// Steps of linear light fine enough that a byte of sRGB is at most one or two from its guess.
constexpr std::size_t guesses = 4096;

/// The byte of the lower end of every step.
std::array<std::uint8_t, guesses + 1> make_guesses(const std::array<double, 256>& limits) {
  std::array<std::uint8_t, guesses + 1> table{};
  for (std::size_t i = 0; i <= guesses; ++i) {
    const double value = static_cast<double>(i) / guesses;
    table[i] = static_cast<std::uint8_t>(std::upper_bound(limits.begin(), limits.end() - 1, value) - limits.begin());
  }
  return table;
}

/// A texture coordinate brought into one period, so that huge coordinates stay exact enough to become integers.
double reduce(double u, Wrap wrap) {
  if (!std::isfinite(u)) return 0;
  switch (wrap) {
  case Wrap::repeat:
    return u - std::floor(u);
  case Wrap::mirror:
    return u - 2 * std::floor(u / 2);
  case Wrap::clamp:
    return std::clamp(u, 0.0, 1.0);
  }
  return 0;
}

/// Texel index for an integer coordinate at most one texel outside the period of `reduce`.
int wrap_texel(int i, int n, Wrap wrap) {
  switch (wrap) {
  case Wrap::repeat:
    return (i + n) % n;
  case Wrap::mirror:
    i = (i + 2 * n) % (2 * n);
    return i < n ? i : 2 * n - 1 - i;
  case Wrap::clamp:
    return std::clamp(i, 0, n - 1);
  }
  return 0;
}

Vec4 texel(const Pixels& pixels, int x, int y) {
  const std::uint8_t* p = &pixels.rgba[4 * (std::size_t(y) * std::size_t(pixels.width) + std::size_t(x))];
  return {linear_of_srgb(p[0]), linear_of_srgb(p[1]), linear_of_srgb(p[2]), p[3] / 255.0};
}

Vec4 sample_linear(const TextureUse& use, double x, double y) {
  const Pixels& pixels = *use.pixels;
  const int i = static_cast<int>(std::floor(x - 0.5)), j = static_cast<int>(std::floor(y - 0.5));
  const double fx = x - 0.5 - i, fy = y - 0.5 - j;
  const int x0 = wrap_texel(i, pixels.width, use.wrap_s), x1 = wrap_texel(i + 1, pixels.width, use.wrap_s);
  const int y0 = wrap_texel(j, pixels.height, use.wrap_t), y1 = wrap_texel(j + 1, pixels.height, use.wrap_t);
  const Vec4 top = glm::mix(texel(pixels, x0, y0), texel(pixels, x1, y0), fx);
  const Vec4 bottom = glm::mix(texel(pixels, x0, y1), texel(pixels, x1, y1), fx);
  return glm::mix(top, bottom, fy);
}

double head_light(const SurfacePoint& point) {
  const double scale = glm::length(point.normal) * glm::length(point.position);
  if (!(scale > 0)) return 1;
  return 0.35 + 0.65 * std::min(1.0, std::abs(glm::dot(point.normal, point.position)) / scale);
}

} // namespace

double linear_of_srgb(std::uint8_t value) {
  static const std::array<double, 256> table = make_srgb_table(0);
  return table[value];
}

std::uint8_t srgb_of_linear(double value) {
  // Where one byte ends and the next begins, and the byte that a first guess may start from.
  static const std::array<double, 256> limits = make_srgb_table(0.5);
  static const std::array<std::uint8_t, guesses + 1> guess = make_guesses(limits);
  if (!(value > 0)) return 0;
  if (value >= limits[254]) return 255;
  std::uint8_t byte = guess[static_cast<std::size_t>(value * guesses)];
  while (value >= limits[byte]) ++byte;
  return byte;
}

double encode_srgb(double linear) {
  const double y = std::clamp(linear, 0.0, 1.0);
  return y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055;
}

double luminance(const Vec3& linear) { return glm::dot(linear, Vec3(0.2126, 0.7152, 0.0722)); }

double lightness(const Vec3& linear) { return encode_srgb(luminance(linear)); }

Vec2 transform_uv(const TextureUse& use, const Vec2& uv) {
  const auto& m = use.transform;
  return {m[0][0] * uv.x + m[0][1] * uv.y + m[0][2], m[1][0] * uv.x + m[1][1] * uv.y + m[1][2]};
}

Vec4 sample(const TextureUse& use, const Vec2& uv) {
  if (!use.pixels) return Vec4(1);
  const int width = use.pixels->width, height = use.pixels->height;
  const double x = reduce(uv.x, use.wrap_s) * width, y = reduce(uv.y, use.wrap_t) * height;
  if (!use.nearest) return sample_linear(use, x, y);
  return texel(*use.pixels, wrap_texel(static_cast<int>(x), width, use.wrap_s),
               wrap_texel(static_cast<int>(y), height, use.wrap_t));
}

double albedo_alpha(const Look& look, double color_alpha, const Vec2& base_uv) {
  return look.base_color.a * color_alpha * sample(look.base, base_uv).a;
}

bool is_present(const Look& look, double albedo_alpha) {
  switch (look.alpha_mode) {
  case AlphaMode::opaque:
    return true;
  case AlphaMode::mask:
    return albedo_alpha >= look.alpha_cutoff;
  case AlphaMode::blend:
    return albedo_alpha >= invisible_alpha;
  }
  return true;
}

Vec3 seen_normal(const SurfacePoint& point) {
  const double length = glm::length(point.normal);
  if (!(length > 0)) return Vec3(0);
  const bool face_turned = glm::dot(point.face, point.position) > 0;
  const bool turned = glm::dot(point.normal, point.face) < 0;
  return point.normal * ((face_turned != turned ? -1 : 1) / length);
}

Vec3 diffuse(const SurfacePoint& point, const Arrival& arrival) {
  const double facing = glm::dot(seen_normal(point), arrival.towards);
  return facing > 0 ? facing * std::numbers::inv_pi * arrival.irradiance : Vec3(0);
}

bool is_unlit(const Look& look, const Lighting& lighting) {
  return look.unlit || lighting.unlit;
}

Vec3 light_at(const Look& look, const SurfacePoint& point, const Lighting& lighting) {
  if (is_unlit(look, lighting)) return Vec3(1);
  if (!lighting.lights) return Vec3(head_light(point));
  Vec3 sum(0);
  for (const PlacedLight& light : *lighting.lights) sum += diffuse(point, arrival(light, point.position));
  return lighting.exposure * sum;
}

Vec4 shade(const Look& look, const SurfacePoint& point, const Vec3& light) {
  const Vec4 albedo = look.base_color * point.color * sample(look.base, point.base_uv);
  Vec3 colour = light * Vec3(albedo);
  if (look.emissive != Vec3(0)) colour += look.emissive * Vec3(sample(look.glow, point.glow_uv));
  return Vec4(colour, look.alpha_mode == AlphaMode::blend ? std::min(albedo.a, 1.0) : 1.0);
}

Vec4 over_background(const Vec4& light, const std::array<std::uint8_t, 4>& background) {
  const double behind = std::max(0.0, 1 - light.a) * background[3] / 255.0;
  if (!(behind > 0)) return light;
  const Vec3 colour(linear_of_srgb(background[0]), linear_of_srgb(background[1]), linear_of_srgb(background[2]));
  return light + behind * Vec4(colour, 1);
}

std::array<std::uint8_t, 4> resolve_pixel(const Vec4& light, const std::array<std::uint8_t, 4>& background) {
  const Vec4 sum = over_background(light, background);
  if (!(sum.a > 0)) return {0, 0, 0, 0};
  std::array<std::uint8_t, 4> pixel{};
  for (int i = 0; i < 3; ++i) pixel[std::size_t(i)] = srgb_of_linear(sum[i] / sum.a);
  pixel[3] = static_cast<std::uint8_t>(std::lround(std::min(sum.a, 1.0) * 255));
  return pixel;
}

} // namespace domewarp
