// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/image.h"
#include "domewarp/scene/scene.h"

namespace domewarp {

enum class Wrap { repeat, clamp, mirror };

/// A texture as a material uses it.
struct TextureUse {
  const Pixels* pixels = nullptr; ///< null: none, white
  Wrap wrap_s = Wrap::repeat, wrap_t = Wrap::repeat;
  bool nearest = false;
  int texcoord = 0;
  double transform[2][3] = {{1, 0, 0}, {0, 1, 0}}; ///< KHR_texture_transform: rows applied to (u, v, 1)
};

/// The part of a material that both renderers draw.
struct Look {
  Vec4 base_color = Vec4(1);
  Vec3 emissive = Vec3(0);
  TextureUse base, glow; ///< base colour and emissive texture
  AlphaMode alpha_mode = AlphaMode::opaque;
  double alpha_cutoff = 0.5;
  bool double_sided = false, unlit = false;
};

/// One primitive of one instance: what both renderers draw, in the same order. The front of triangles is where the
/// triangles are counter-clockwise in world space, whatever the instance's matrix (read_scene sees to that).
struct Part {
  const Primitive* primitive = nullptr;
  Mat4 world = Mat4(1);
  std::uint32_t object = 0;         ///< instance index + 1
  std::uint32_t first_triangle = 0; ///< triangles of the instance before this primitive
  const Look* look = nullptr;
  const Attribute* normal = nullptr; ///< each null when the primitive has none of the right shape
  const Attribute* color = nullptr;
  const Attribute* base_uv = nullptr;
  const Attribute* glow_uv = nullptr;
  const Attribute* source = nullptr; ///< _SOURCE_POSITION
};

/// A scene made ready for drawing. Points into the scene it was made from.
struct Parts {
  std::vector<Pixels> images; ///< decoded, by index of Scene::images; empty where no drawn material reads it
  std::vector<Look> looks;    ///< looks[0] is glTF's default material, looks[i + 1] material i
  std::vector<Part> parts;    ///< triangles
  std::vector<Part> strokes;  ///< points and lines
  std::vector<std::string> warnings; ///< one sentence for each image that is missing or broken and drawn white
};

/// @throws Error(input) when the scene refers to something it does not have.
Parts prepare_parts(const Scene& scene);

} // namespace domewarp
