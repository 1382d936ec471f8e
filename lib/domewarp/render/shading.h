// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/render/lights.h"
#include "domewarp/render/parts.h"

namespace domewarp {

// The one definition of what a surface looks like, for both renderers (gl_shaders.cpp says the same in GLSL):
//
//   albedo = base_color * base_texture(uv) * COLOR_0
//   light  = 1 when unlit;
//            with the scene's own lights: exposure / pi * sum over them of irradiance * max(0, n . l);
//            else 0.35 + 0.65 |n . v|, v from the source position to the eye
//   colour = light * albedo.rgb + emissive * emissive_texture(uv)
//   alpha  = 1 when opaque; mask: nothing where albedo.a < cutoff, else 1; blend: albedo.a, nothing below 1/510
//
// All in linear light. Textures are read at full resolution with the sampler's wrap, bilinear between decoded texels or
// nearest as its magnification filter says. n is NORMAL, else the normal of the triangle, turned to the side of the
// triangle that is seen.

/// What the renderers know about a point of a surface, in eye space.
struct SurfacePoint {
  Vec3 position = Vec3(0);
  Vec3 normal = Vec3(0);                     ///< any length; zero counts as facing the eye
  Vec3 face = Vec3(0);                       ///< normal of the triangle, any length, either side
  Vec4 color = Vec4(1);                      ///< COLOR_0, linear
  Vec2 base_uv = Vec2(0), glow_uv = Vec2(0); ///< after the texture transform
};

/// What lights everything.
struct Lighting {
  bool unlit = false;
  const std::vector<PlacedLight>* lights = nullptr; ///< null: one at the eye
  double exposure = 1;                              ///< of `lights`
};

/// Blended surfaces with less alpha than this are not there: half an 8-bit step.
inline constexpr double invisible_alpha = 1.0 / 510;

/// Linear light of an 8-bit sRGB value, and back (rounded, out-of-range values clamped, NaN black).
double linear_of_srgb(std::uint8_t value);

/// Linear light on the scale of sRGB, 0..1, not rounded; out-of-range values clamped.
double encode_srgb(double linear);

/// Rec. 709 luminance of a linear colour.
double luminance(const Vec3& linear);
std::uint8_t srgb_of_linear(double value);

/// Texture coordinates after the texture transform.
Vec2 transform_uv(const TextureUse& use, const Vec2& uv);

/// Linear colour and alpha at texture coordinates (white without a texture; coordinates that are not finite read 0).
Vec4 sample(const TextureUse& use, const Vec2& uv);

/// albedo.a alone, for alpha tests.
double albedo_alpha(const Look& look, double color_alpha, const Vec2& base_uv);

/// Whether a fragment of this albedo alpha is there at all.
bool is_present(const Look& look, double albedo_alpha);

/// The normal, unit, on the side of the triangle that is seen; zero when there is none.
Vec3 seen_normal(const SurfacePoint& point);

/// What one light adds to `light` above, before the exposure.
Vec3 diffuse(const SurfacePoint& point, const Arrival& arrival);

bool is_unlit(const Look& look, const Lighting& lighting);

/// `light` above, without shadows.
Vec3 light_at(const Look& look, const SurfacePoint& point, const Lighting& lighting);

/// Linear colour, straight alpha. @param light as `light_at` gives it
Vec4 shade(const Look& look, const SurfacePoint& point, const Vec3& light);

/// How bright a linear colour looks, 0..1: its Rec. 709 luminance on the scale of sRGB, where equal steps are equally
/// visible.
double lightness(const Vec3& linear);

/// Accumulated light (linear, multiplied by alpha, alpha last) over a background (sRGB, straight), likewise.
Vec4 over_background(const Vec4& light, const std::array<std::uint8_t, 4>& background);

/// One pixel from its accumulated light (linear, multiplied by alpha, alpha last) over a background (sRGB, straight).
std::array<std::uint8_t, 4> resolve_pixel(const Vec4& light, const std::array<std::uint8_t, 4>& background);

} // namespace domewarp
