// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/shading.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace domewarp {
namespace {

/// Texels black, red, green, blue, white from left to right, one row.
Pixels strip() {
  return {5, 1, {0, 0, 0, 255, 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}};
}

TextureUse use_of(const Pixels& pixels, Wrap wrap, bool nearest) {
  TextureUse use;
  use.pixels = &pixels;
  use.wrap_s = use.wrap_t = wrap;
  use.nearest = nearest;
  return use;
}

void expect_colour(const Vec4& a, const Vec4& b) {
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(a[i], b[i], 1e-12) << "channel " << i;
}

const Vec4 red(1, 0, 0, 1), blue(0, 0, 1, 1), white(1), black(0, 0, 0, 1);

TEST(Shading, SrgbComesBackFromLinearLight) {
  for (int i = 0; i < 256; ++i) EXPECT_EQ(srgb_of_linear(linear_of_srgb(static_cast<std::uint8_t>(i))), i);
  EXPECT_EQ(srgb_of_linear(7.0), 255);
  EXPECT_EQ(srgb_of_linear(-1.0), 0);
  EXPECT_EQ(srgb_of_linear(std::numeric_limits<double>::quiet_NaN()), 0);
}

TEST(Shading, RepeatGoesRound) {
  const Pixels pixels = strip();
  for (const double turn : {-3.0, -1.0, 0.0, 1.0, 1000.0})
    expect_colour(sample(use_of(pixels, Wrap::repeat, true), {turn + 0.3, 0.5}), red);
}

TEST(Shading, MirrorTurnsBack) {
  const Pixels pixels = strip();
  expect_colour(sample(use_of(pixels, Wrap::mirror, true), {1.3, 0.5}), blue);
  expect_colour(sample(use_of(pixels, Wrap::mirror, true), {-0.3, 0.5}), red);
  expect_colour(sample(use_of(pixels, Wrap::mirror, true), {2.3, 0.5}), red);
}

TEST(Shading, ClampKeepsTheEdge) {
  const Pixels pixels = strip();
  expect_colour(sample(use_of(pixels, Wrap::clamp, false), {1.7, 0.5}), white);
  expect_colour(sample(use_of(pixels, Wrap::clamp, false), {-9, 0.5}), black);
}

TEST(Shading, LinearFilterMixesInLinearLight) {
  const Pixels pixels = strip();
  expect_colour(sample(use_of(pixels, Wrap::clamp, false), {0.2, 0.5}), {0.5, 0, 0, 1});
  expect_colour(sample(use_of(pixels, Wrap::repeat, false), {0.0, 0.5}), {0.5, 0.5, 0.5, 1});
}

TEST(Shading, WildCoordinatesAreHarmless) {
  const Pixels pixels = strip();
  const double inf = std::numeric_limits<double>::infinity();
  for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror})
    for (const bool nearest : {false, true})
      for (const double u : {inf, -inf, std::nan(""), 1e300, -1e300, -1e-300, 1 - 1e-17, -1e-17, 2 - 1e-16})
        EXPECT_TRUE(std::isfinite(sample(use_of(pixels, wrap, nearest), {u, u}).x));
}

TEST(Shading, TextureTransformScalesThenTurnsThenShifts) {
  Scene scene;
  scene.images.resize(1);
  scene.images[0].bytes = encode_png(5, 1, 4, strip().rgba);
  scene.textures.resize(1);
  scene.textures[0].image = 0;
  scene.materials.resize(1);
  TextureReference& reference = scene.materials[0].base_texture;
  reference.texture = 0;
  reference.scale = {2, 3};
  reference.rotation = 0.5 * std::acos(-1.0);
  reference.offset = {0.25, 0.5};
  Primitive triangle;
  triangle.material = 0;
  scene.meshes = {{"", {triangle}}};
  scene.instances.resize(1);
  const Parts parts = prepare_parts(scene);
  const Vec2 uv = transform_uv(parts.looks[1].base, {0.1, 0.2});
  EXPECT_NEAR(uv.x, 0.25 + 0.6, 1e-12);
  EXPECT_NEAR(uv.y, 0.5 - 0.2, 1e-12);
}

TEST(Shading, MaskAndBlendDecideWhatIsThere) {
  Look look;
  EXPECT_TRUE(is_present(look, 0));
  look.alpha_mode = AlphaMode::mask;
  look.alpha_cutoff = 0.25;
  EXPECT_TRUE(is_present(look, 0.25));
  EXPECT_FALSE(is_present(look, 0.2499));
  look.alpha_mode = AlphaMode::blend;
  EXPECT_TRUE(is_present(look, 0.01));
  EXPECT_FALSE(is_present(look, 0));
}

TEST(Shading, LightFallsWithTheSlantUnlessUnlit) {
  Look look;
  look.base_color = Vec4(0.5, 0.5, 0.5, 1);
  SurfacePoint point;
  point.position = {0, 0, -3};
  point.normal = {0, 0, 7};
  expect_colour(shade(look, point, light_at(look, point, {})), {0.5, 0.5, 0.5, 1});
  point.normal = {0, 2, 0};
  expect_colour(shade(look, point, light_at(look, point, {})), {0.175, 0.175, 0.175, 1});
  expect_colour(shade(look, point, light_at(look, point, {.unlit = true})), {0.5, 0.5, 0.5, 1});
}

TEST(Shading, EmissiveIsAddedWithoutLight) {
  Look look;
  look.base_color = Vec4(0, 0, 0, 1);
  look.emissive = {0.25, 0.5, 2};
  expect_colour(shade(look, SurfacePoint{}, light_at(look, SurfacePoint{}, {})), {0.25, 0.5, 2, 1});
}

TEST(Shading, ResolveComposesOverTheBackground) {
  const std::array<std::uint8_t, 4> clear = {0, 0, 0, 0}, blue_paper = {0, 0, 255, 255};
  EXPECT_EQ(resolve_pixel(Vec4(0), clear), clear);
  EXPECT_EQ(resolve_pixel(Vec4(0), blue_paper), blue_paper);
  EXPECT_EQ(resolve_pixel({0.5, 0, 0, 0.5}, clear), (std::array<std::uint8_t, 4>{255, 0, 0, 128}));
  EXPECT_EQ(resolve_pixel({0.5, 0, 0, 0.5}, blue_paper), (std::array<std::uint8_t, 4>{188, 0, 188, 255}));
}

} // namespace
} // namespace domewarp
