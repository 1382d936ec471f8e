// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <glm/mat4x4.hpp>

#include "domewarp/render/frame.h"
#include "domewarp/render/gl_context.h"
#include "domewarp/render/gl_geometry.h"
#include "domewarp/render/lights.h"
#include "domewarp/render/parts.h"

namespace domewarp {

/// A rectangle of the picture, in samples.
struct Tile {
  int left = 0, top = 0, width = 0, height = 0;
};

/// How everything is lit and seen.
struct GlScenery {
  bool unlit = false;
  const std::vector<PlacedLight>* lights = nullptr; ///< null: one at the eye
  double exposure = 1;
  bool parallel = false; ///< the eye is infinitely far along +z, for primitives without source positions
  bool mirrored = false; ///< the camera turns all triangles round
};

/// A scene on the graphics device, ready to be drawn tile by tile. Needs a current GlContext.
class GlDrawing {
 public:
  /// @param parts, geometry must outlive the object
  GlDrawing(const Parts& parts, const GlGeometry& geometry, const GlScenery& scenery);

  /// Draws one tile into the bound framebuffer's lower left corner.
  /// @param projection camera space to the clip space of the whole picture of `width` x `height` samples
  void draw(const glm::mat4& projection, int width, int height, const Tile& tile) const;

 private:
  const Parts& parts_;
  const GlGeometry& geometry_;
  GlScenery scenery_;
  GlObject program_;
  GlObject vertices_, triangles_, strokes_, ids_, lights_;
  GlObject array_;
  std::vector<GlObject> textures_; ///< by image, no name where unused

  void draw_triangles(const std::vector<GlBatch>& batches) const;
  void draw_strokes() const;
  std::size_t draw_block(std::size_t first, std::size_t most) const;
  void apply(const Look& look, bool unlit) const;
  void apply(const TextureUse& use, const char* uniform, unsigned unit) const;
  int location(const char* name) const;
  void set(const char* name, int value) const;
};

/// Room for a tile on the graphics device and on its way back, lowest row first.
class GlTarget {
 public:
  GlTarget(int width, int height, Layers layers);
  void bind() const;
  void clear() const;
  /// Copies the lower left width x height pixels into the vectors below.
  void read(int width, int height);

  std::vector<Vec4f> colour, source, normal; ///< normal.w is 1 where something was drawn
  std::vector<Vec2f> uv;
  std::vector<GlIds> ids;

 private:
  Layers layers_;
  GlObject framebuffer_, depth_;
  std::vector<GlObject> textures_;

  void attach(const GlObject& texture, unsigned format, unsigned attachment, int width, int height) const;
};

/// The most samples across that the driver can draw at once.
int largest_tile();

/// The driver rounds vertices to 2^-this pixels.
int subpixel_bits();

} // namespace domewarp
