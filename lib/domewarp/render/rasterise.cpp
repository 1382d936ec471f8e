// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/rasterise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/render/gl_context.h"
#include "domewarp/render/gl_geometry.h"
#include "domewarp/render/gl_shaders.h"
#include "domewarp/render/parts.h"
#include "domewarp/render/shading.h"

namespace domewarp {

namespace {

/// Triangles whose ids are bound at once: 8 MiB, below every driver's limit for a storage buffer.
constexpr std::size_t id_block = std::size_t{1} << 20;

struct Tile {
  int left = 0, top = 0, width = 0, height = 0;
};

/// Colour, source position, ids and depth of a tile.
struct Target {
  GlObject framebuffer = make_framebuffer();
  GlObject colour = make_texture(), source = make_texture(), ids = make_texture(), depth = make_texture();
};

/// A scene on the graphics device.
struct Drawing {
  GlObject program;
  GlObject vertices = make_buffer(), triangles = make_buffer(), ids = make_buffer();
  GlObject array = make_vertex_array();
  std::vector<GlObject> textures; ///< by image, no name where unused
};

[[noreturn]] void refuse_camera(const Camera& camera, const std::string& reason) {
  throw Error(ErrorCode::input, "camera " + (camera.name.empty() ? std::string("0") : camera.name) + ": " + reason);
}

const Camera& checked_camera(const Scene& scene) {
  if (scene.cameras.empty()) throw Error(ErrorCode::input, "scene: has no camera to draw through");
  const Camera& camera = scene.cameras.front();
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

/// Camera space to the clip space of one tile.
glm::mat4 tile_projection(const Camera& camera, const Raster& raster, const Tile& tile) {
  const double half_height = camera.perspective ? std::tan(camera.yfov / 2) : camera.ymag;
  const double across = double(raster.width) / tile.width, up = double(raster.height) / tile.height;
  const double x = (2.0 * tile.left + tile.width) / raster.width - 1;
  const double y = 1 - (2.0 * tile.top + tile.height) / raster.height;
  const Vec2 depth = depth_row(camera);
  Mat4 m(0);
  m[0][0] = across / (half_height * aspect(raster));
  m[1][1] = up / half_height;
  // clip.xy = (xy - centre of the tile * w) * tiles per picture, with w = -z or 1.
  const int w_column = camera.perspective ? 2 : 3;
  const double w_factor = camera.perspective ? -1 : 1;
  m[w_column][0] = -x * across * w_factor;
  m[w_column][1] = -y * up * w_factor;
  m[w_column][3] = w_factor;
  m[2][2] += depth.x;
  m[3][2] += depth.y;
  return glm::mat4(m);
}

template <typename T>
void upload(const GlObject& buffer, const std::vector<T>& values) {
  const std::size_t bytes = std::max<std::size_t>(values.size() * sizeof(T), 4);
  glNamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(bytes), values.empty() ? nullptr : values.data(), 0);
}

void describe_vertices(const Drawing& drawing) {
  const GLuint array = drawing.array.name();
  glVertexArrayVertexBuffer(array, 0, drawing.vertices.name(), 0, sizeof(GlVertex));
  glVertexArrayElementBuffer(array, drawing.triangles.name());
  const struct {
    GLint components;
    std::size_t offset;
  } inputs[] = {{3, offsetof(GlVertex, position)},
                {4, offsetof(GlVertex, source)},
                {3, offsetof(GlVertex, normal)},
                {4, offsetof(GlVertex, colour)},
                {4, offsetof(GlVertex, uv)}};
  for (GLuint i = 0; i < 5; ++i) {
    glEnableVertexArrayAttrib(array, i);
    glVertexArrayAttribFormat(array, i, inputs[i].components, GL_FLOAT, GL_FALSE,
                              static_cast<GLuint>(inputs[i].offset));
    glVertexArrayAttribBinding(array, i, 0);
  }
}

GlObject upload_texture(const Pixels& pixels, std::size_t index) {
  if (pixels.rgba.empty()) return {};
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  if (std::max(pixels.width, pixels.height) > limit)
    throw Error(ErrorCode::output, "OpenGL: image " + std::to_string(index) + " of " + std::to_string(pixels.width) +
                                       " x " + std::to_string(pixels.height) + " pixels exceeds the driver's " +
                                       std::to_string(limit));
  GlObject texture = make_texture();
  glTextureStorage2D(texture.name(), 1, GL_SRGB8_ALPHA8, pixels.width, pixels.height);
  glTextureSubImage2D(texture.name(), 0, 0, 0, pixels.width, pixels.height, GL_RGBA, GL_UNSIGNED_BYTE,
                      pixels.rgba.data());
  glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return texture;
}

Drawing make_drawing(const Parts& parts, const GlGeometry& geometry) {
  Drawing drawing;
  drawing.program = make_program(vertex_shader_source, fragment_shader_source);
  upload(drawing.vertices, geometry.vertices);
  upload(drawing.triangles, geometry.triangles);
  upload(drawing.ids, geometry.ids);
  describe_vertices(drawing);
  for (std::size_t i = 0; i < parts.images.size(); ++i) drawing.textures.push_back(upload_texture(parts.images[i], i));
  check_gl("copying the scene to the graphics device");
  return drawing;
}

Target make_target(int size_x, int size_y) {
  Target target;
  const struct {
    const GlObject& texture;
    GLenum format, attachment;
  } layers[] = {{target.colour, GL_RGBA32F, GL_COLOR_ATTACHMENT0},
                {target.source, GL_RGBA32F, GL_COLOR_ATTACHMENT1},
                {target.ids, GL_RG32UI, GL_COLOR_ATTACHMENT2},
                {target.depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT}};
  const GLuint framebuffer = target.framebuffer.name();
  for (const auto& layer : layers) {
    glTextureStorage2D(layer.texture.name(), 1, layer.format, size_x, size_y);
    glNamedFramebufferTexture(framebuffer, layer.attachment, layer.texture.name(), 0);
  }
  const GLenum outputs[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
  glNamedFramebufferDrawBuffers(framebuffer, 3, outputs);
  check_gl("making a target of " + std::to_string(size_x) + " x " + std::to_string(size_y) + " pixels");
  if (glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(ErrorCode::output, "OpenGL: the driver cannot draw into float and integer targets");
  return target;
}

void clear_target(const Target& target) {
  const GLuint framebuffer = target.framebuffer.name();
  const GLfloat zero[4] = {};
  const GLuint no_ids[4] = {};
  glDepthMask(GL_TRUE);
  for (GLuint i = 0; i < 3; ++i) glColorMaski(i, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, zero);
  glClearNamedFramebufferfv(framebuffer, GL_COLOR, 1, zero);
  glClearNamedFramebufferuiv(framebuffer, GL_COLOR, 2, no_ids);
  glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, zero);
}

class Painter {
 public:
  Painter(const Parts& parts, const Drawing& drawing, bool unlit) : parts_(parts), drawing_(drawing), unlit_(unlit) {
    glUseProgram(drawing.program.name());
    glBindVertexArray(drawing.array.name());
    set("base_map", 0);
    set("glow_map", 1);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  }

  /// A camera that mirrors turns all triangles round in the picture.
  void set_mirrored(bool mirrored) const { glFrontFace(mirrored ? GL_CW : GL_CCW); }

  void set_projection(const glm::mat4& m) const { glUniformMatrix4fv(location("projection"), 1, GL_FALSE, &m[0][0]); }

  void draw(const std::vector<GlBatch>& batches) const {
    for (const GlBatch& batch : batches) {
      apply(*batch.look);
      for (std::size_t done = 0; done < batch.count;) done += draw_block(batch.first + done, batch.count - done);
    }
  }

 private:
  const Parts& parts_;
  const Drawing& drawing_;
  bool unlit_;

  GLint location(const char* name) const { return glGetUniformLocation(drawing_.program.name(), name); }
  void set(const char* name, int value) const { glUniform1i(location(name), value); }

  void apply(const Look& look) const {
    if (look.double_sided)
      glDisable(GL_CULL_FACE);
    else
      glEnable(GL_CULL_FACE);
    set("alpha_mode", static_cast<int>(look.alpha_mode));
    glUniform1f(location("alpha_cutoff"), static_cast<float>(look.alpha_cutoff));
    set("unlit", unlit_ || look.unlit);
    const glm::vec3 emissive(look.emissive);
    glUniform3fv(location("emissive"), 1, &emissive[0]);
    apply(look.base, "base_use", 0);
    apply(look.glow, "glow_use", 1);
  }

  void apply(const TextureUse& use, const char* uniform, GLuint unit) const {
    glUniform4i(location(uniform), use.pixels != nullptr, static_cast<int>(use.wrap_s), static_cast<int>(use.wrap_t),
                use.nearest);
    if (use.pixels) glBindTextureUnit(unit, drawing_.textures[std::size_t(use.pixels - parts_.images.data())].name());
  }

  /// Draws up to `most` triangles from `first`, as far as one block of ids reaches.
  std::size_t draw_block(std::size_t first, std::size_t most) const {
    const std::size_t block = first / id_block * id_block;
    const std::size_t count = std::min(most, block + id_block - first);
    const std::size_t bytes = (first + count - block) * sizeof(GlIds);
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 0, drawing_.ids.name(), static_cast<GLintptr>(block * sizeof(GlIds)),
                      static_cast<GLsizeiptr>(bytes));
    set("first_triangle", static_cast<int>(first - block));
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(first * sizeof(GlTriangle)));
    return count;
  }
};

void mask_outputs(bool colour, bool others) {
  glColorMaski(0, colour, colour, colour, colour);
  for (GLuint i = 1; i < 3; ++i) glColorMaski(i, others, others, others, others);
  glDepthMask(others);
}

/// Blended triangles are drawn twice: all their colours, then ids, positions and depth of the nearest. In one pass
/// either the depth written by a near triangle hides colours drawn later, or the ids are those of whatever came last.
void draw_all(const Painter& painter, const GlGeometry& geometry) {
  painter.draw(geometry.opaque);
  if (geometry.blended.empty()) return;
  glEnablei(GL_BLEND, 0);
  mask_outputs(true, false);
  painter.draw(geometry.blended);
  glDisablei(GL_BLEND, 0);
  mask_outputs(false, true);
  painter.draw(geometry.blended);
}

/// Room for a tile on its way back, lowest row first.
struct Readback {
  std::vector<Vec4f> colour, source;
  std::vector<GlIds> ids;
};

void read_target(const Tile& tile, Readback& data) {
  const std::size_t count = std::size_t(tile.width) * std::size_t(tile.height);
  data.colour.resize(count);
  data.source.resize(count);
  data.ids.resize(count);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, tile.width, tile.height, GL_RGBA, GL_FLOAT, data.colour.data());
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, tile.width, tile.height, GL_RGBA, GL_FLOAT, data.source.data());
  glReadBuffer(GL_COLOR_ATTACHMENT2);
  glReadPixels(0, 0, tile.width, tile.height, GL_RG_INTEGER, GL_UNSIGNED_INT, data.ids.data());
  check_gl("drawing");
}

void store_pixel(Frame& frame, std::size_t pixel, const Readback& data, std::size_t i, const RasterOptions& options) {
  const auto colour = resolve_pixel(Vec4(data.colour[i]), options.background);
  std::copy(colour.begin(), colour.end(), &frame.rgba[4 * pixel]);
  frame.object[pixel] = data.ids[i].object;
  frame.triangle[pixel] = data.ids[i].triangle;
  if (!data.ids[i].object || data.source[i].w < 0.5f) return;
  frame.position[pixel] = Vec3f(data.source[i]);
  frame.depth[pixel] = static_cast<float>(glm::length(Vec3(data.source[i])));
}

void store_tile(Frame& frame, const Tile& tile, const Readback& data, const RasterOptions& options) {
  parallel_each(std::size_t(tile.height), 16, [&](std::size_t row) {
    const std::size_t from = (std::size_t(tile.height) - 1 - row) * std::size_t(tile.width);
    const std::size_t to = (std::size_t(tile.top) + row) * std::size_t(frame.width) + std::size_t(tile.left);
    for (std::size_t i = 0; i < std::size_t(tile.width); ++i) store_pixel(frame, to + i, data, from + i, options);
  });
}

/// What the driver can draw at once, and no more than asked for.
int tile_size(const RasterOptions& options) {
  GLint texture = 0, viewport[2] = {};
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  return std::clamp(std::min({options.tile, texture, viewport[0], viewport[1]}), 1, 1 << 14);
}

std::vector<Tile> cut(const Raster& raster, int size) {
  std::vector<Tile> tiles;
  for (int top = 0; top < raster.height; top += size)
    for (int left = 0; left < raster.width; left += size)
      tiles.push_back({left, top, std::min(size, raster.width - left), std::min(size, raster.height - top)});
  return tiles;
}

} // namespace

Frame rasterise(const Scene& scene, const Raster& raster, const RasterOptions& options) {
  Frame frame = make_frame(raster.width, raster.height);
  const Camera& camera = checked_camera(scene);
  const Parts parts = prepare_parts(scene);
  const GlGeometry geometry = make_gl_geometry(parts, glm::inverse(camera.world));
  const GlContext context;
  frame.renderer = context.driver();
  frame.warnings = parts.warnings;
  const Drawing drawing = make_drawing(parts, geometry);
  const int size = tile_size(options);
  const Target target = make_target(std::min(size, raster.width), std::min(size, raster.height));
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  const Painter painter(parts, drawing, options.unlit);
  painter.set_mirrored(glm::determinant(camera.world) < 0);
  Readback data;
  for (const Tile& tile : cut(raster, size)) {
    glViewport(0, 0, tile.width, tile.height);
    clear_target(target);
    painter.set_projection(tile_projection(camera, raster, tile));
    draw_all(painter, geometry);
    read_target(tile, data);
    store_tile(frame, tile, data, options);
  }
  return frame;
}

} // namespace domewarp
