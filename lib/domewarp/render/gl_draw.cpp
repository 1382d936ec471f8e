// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/gl_draw.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include "domewarp/core/errors.h"
#include "domewarp/render/gl_shaders.h"

namespace domewarp {

namespace {

/// Triangles whose ids are bound at once: 8 MiB, below every driver's limit for a storage buffer.
constexpr std::size_t id_block = std::size_t{1} << 20;

/// PlacedLight as the shader reads it.
struct GlLight {
  float position[3], kind;
  float direction[3], range;
  float strength[3], cone_scale;
  float cone_offset, unused[3];
};

GlLight to_gl(const PlacedLight& light) {
  GlLight result{};
  for (int i = 0; i < 3; ++i) {
    result.position[i] = static_cast<float>(light.position[i]);
    result.direction[i] = static_cast<float>(light.direction[i]);
    result.strength[i] = static_cast<float>(light.strength[i]);
  }
  result.kind = static_cast<float>(light.kind);
  result.range = static_cast<float>(light.range);
  result.cone_scale = static_cast<float>(light.cone_scale);
  result.cone_offset = static_cast<float>(light.cone_offset);
  return result;
}

template <typename T>
void upload(const GlObject& buffer, const std::vector<T>& values) {
  const std::size_t bytes = std::max<std::size_t>(values.size() * sizeof(T), 4);
  glNamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(bytes), values.empty() ? nullptr : values.data(), 0);
}

void describe_vertices(GLuint array, const GlObject& vertices) {
  glVertexArrayVertexBuffer(array, 0, vertices.name(), 0, sizeof(GlVertex));
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

/// Depth and the layers beside colour are written together, or not at all.
void mask_outputs(bool colour, bool others) {
  glColorMaski(0, colour, colour, colour, colour);
  for (GLuint i = 1; i < 5; ++i) glColorMaski(i, others, others, others, others);
  glDepthMask(others);
}

template <typename T>
void read_layer(std::vector<T>& data, GLenum attachment, int width, int height, GLenum format, GLenum type) {
  data.resize(std::size_t(width) * std::size_t(height));
  glReadBuffer(attachment);
  glReadPixels(0, 0, width, height, format, type, data.data());
}

} // namespace

GlDrawing::GlDrawing(const Parts& parts, const GlGeometry& geometry, const GlScenery& scenery)
    : parts_(parts),
      geometry_(geometry),
      scenery_(scenery),
      program_(make_program(vertex_shader_source, fragment_shader_source)),
      vertices_(make_buffer()),
      triangles_(make_buffer()),
      strokes_(make_buffer()),
      ids_(make_buffer()),
      lights_(make_buffer()),
      array_(make_vertex_array()) {
  upload(vertices_, geometry.vertices);
  upload(triangles_, geometry.triangles);
  upload(strokes_, geometry.strokes);
  upload(ids_, geometry.ids);
  std::vector<GlLight> lights;
  if (scenery.lights) std::transform(scenery.lights->begin(), scenery.lights->end(), std::back_inserter(lights), to_gl);
  lights.emplace_back(); // a buffer is never empty
  upload(lights_, lights);
  describe_vertices(array_.name(), vertices_);
  for (std::size_t i = 0; i < parts.images.size(); ++i) textures_.push_back(upload_texture(parts.images[i], i));
  check_gl("copying the scene to the graphics device");
}

int GlDrawing::location(const char* name) const {
  return glGetUniformLocation(program_.name(), name);
}

void GlDrawing::set(const char* name, int value) const {
  glUniform1i(location(name), value);
}

namespace {

/// What the driver clips by: the whole picture where it can, so that no tile's border cuts a triangle.
Tile window_of(int width, int height, const Tile& tile) {
  GLint most[2] = {};
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, most);
  return width <= most[0] && height <= most[1] ? Tile{0, 0, width, height} : tile;
}

} // namespace

/// Blended triangles are drawn twice: all their colours, then ids, positions and depth of the nearest. In one pass
/// either the depth written by a near triangle hides colours drawn later, or the ids are those of whatever came last.
void GlDrawing::draw(const glm::mat4& projection, int width, int height, const Tile& tile) const {
  const Tile window = window_of(width, height, tile);
  const int bottom = height - tile.top - tile.height;
  glViewport(window.left - tile.left, height - window.top - window.height - bottom, window.width, window.height);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, tile.width, tile.height);
  glUseProgram(program_.name());
  glBindVertexArray(array_.name());
  set("base_map", 0);
  set("glow_map", 1);
  set("light_count", scenery_.lights ? static_cast<int>(scenery_.lights->size()) : -1);
  set("parallel_view", scenery_.parallel);
  glUniform1f(location("exposure"), static_cast<float>(scenery_.exposure));
  glUniformMatrix4fv(location("projection"), 1, GL_FALSE, &projection[0][0]);
  glUniform2f(location("picture"), static_cast<float>(width), static_cast<float>(height));
  glUniform4f(location("window"), static_cast<float>(window.left), static_cast<float>(height - window.top - window.height),
              static_cast<float>(window.width), static_cast<float>(window.height));
  glUniform1f(location("subpixels"), static_cast<float>(1 << subpixel_bits()));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, lights_.name());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glFrontFace(scenery_.mirrored ? GL_CW : GL_CCW);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  mask_outputs(true, true);
  draw_triangles(geometry_.opaque);
  draw_strokes();
  if (geometry_.blended.empty()) return;
  glEnablei(GL_BLEND, 0);
  mask_outputs(true, false);
  draw_triangles(geometry_.blended);
  glDisablei(GL_BLEND, 0);
  mask_outputs(false, true);
  draw_triangles(geometry_.blended);
}

void GlDrawing::draw_triangles(const std::vector<GlBatch>& batches) const {
  glVertexArrayElementBuffer(array_.name(), triangles_.name());
  for (const GlBatch& batch : batches) {
    apply(*batch.look, scenery_.unlit);
    for (std::size_t done = 0; done < batch.count;) done += draw_block(batch.first + done, batch.count - done);
  }
}

/// Draws up to `most` triangles from `first`, as far as one block of ids reaches.
std::size_t GlDrawing::draw_block(std::size_t first, std::size_t most) const {
  const std::size_t block = first / id_block * id_block;
  const std::size_t count = std::min(most, block + id_block - first);
  const std::size_t bytes = (first + count - block) * sizeof(GlIds);
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 0, ids_.name(), static_cast<GLintptr>(block * sizeof(GlIds)),
                    static_cast<GLsizeiptr>(bytes));
  set("first_triangle", static_cast<int>(first - block));
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * count), GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(first * sizeof(GlTriangle)));
  return count;
}

/// Without ids of their own: rays know nothing of them.
void GlDrawing::draw_strokes() const {
  if (geometry_.stroke_batches.empty()) return;
  for (GLuint i = 1; i < 5; ++i) glColorMaski(i, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glVertexArrayElementBuffer(array_.name(), strokes_.name());
  for (const GlStrokes& batch : geometry_.stroke_batches) {
    apply(*batch.look, true);
    glDrawElements(batch.topology == Topology::points ? GL_POINTS : GL_LINES, static_cast<GLsizei>(batch.count),
                   GL_UNSIGNED_INT, reinterpret_cast<const void*>(batch.first * sizeof(std::uint32_t)));
  }
}

void GlDrawing::apply(const Look& look, bool unlit) const {
  if (look.double_sided)
    glDisable(GL_CULL_FACE);
  else
    glEnable(GL_CULL_FACE);
  set("alpha_mode", static_cast<int>(look.alpha_mode));
  glUniform1f(location("alpha_cutoff"), static_cast<float>(look.alpha_cutoff));
  set("unlit", unlit || look.unlit);
  const glm::vec3 emissive(look.emissive);
  glUniform3fv(location("emissive"), 1, &emissive[0]);
  apply(look.base, "base_use", 0);
  apply(look.glow, "glow_use", 1);
}

void GlDrawing::apply(const TextureUse& use, const char* uniform, unsigned unit) const {
  glUniform4i(location(uniform), use.pixels != nullptr, static_cast<int>(use.wrap_s), static_cast<int>(use.wrap_t),
              use.nearest);
  if (use.pixels) glBindTextureUnit(unit, textures_[std::size_t(use.pixels - parts_.images.data())].name());
}

GlTarget::GlTarget(int width, int height, Layers layers)
    : layers_(layers), framebuffer_(make_framebuffer()), depth_(make_texture()) {
  const GLenum formats[] = {GL_RGBA32F, GL_RGBA32F, GL_RG32UI, GL_RGBA32F, GL_RG32F};
  const GLuint count = layers == Layers::colours ? 1 : layers == Layers::parity ? 3 : 5;
  std::vector<GLenum> outputs;
  for (GLuint i = 0; i < count; ++i) {
    textures_.push_back(make_texture());
    outputs.push_back(GL_COLOR_ATTACHMENT0 + i);
    attach(textures_.back(), formats[i], outputs.back(), width, height);
  }
  attach(depth_, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, width, height);
  glNamedFramebufferDrawBuffers(framebuffer_.name(), static_cast<GLsizei>(count), outputs.data());
  check_gl("making a target of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
  if (glCheckNamedFramebufferStatus(framebuffer_.name(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(ErrorCode::output, "OpenGL: the driver cannot draw into float and integer targets");
}

void GlTarget::attach(const GlObject& texture, unsigned format, unsigned attachment, int width, int height) const {
  glTextureStorage2D(texture.name(), 1, format, width, height);
  glNamedFramebufferTexture(framebuffer_.name(), attachment, texture.name(), 0);
}

void GlTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
}

void GlTarget::clear() const {
  glDisable(GL_SCISSOR_TEST); // it would cut the clearing
  const GLfloat zero[4] = {};
  const GLuint no_ids[4] = {};
  mask_outputs(true, true);
  for (GLint i = 0; i < static_cast<GLint>(textures_.size()); ++i)
    if (i == 2)
      glClearNamedFramebufferuiv(framebuffer_.name(), GL_COLOR, i, no_ids);
    else
      glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, i, zero);
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, zero);
}

void GlTarget::read(int width, int height) {
  read_layer(colour, GL_COLOR_ATTACHMENT0, width, height, GL_RGBA, GL_FLOAT);
  if (layers_ != Layers::colours) {
    read_layer(source, GL_COLOR_ATTACHMENT1, width, height, GL_RGBA, GL_FLOAT);
    read_layer(ids, GL_COLOR_ATTACHMENT2, width, height, GL_RG_INTEGER, GL_UNSIGNED_INT);
  }
  if (layers_ == Layers::all) {
    read_layer(normal, GL_COLOR_ATTACHMENT3, width, height, GL_RGBA, GL_FLOAT);
    read_layer(uv, GL_COLOR_ATTACHMENT4, width, height, GL_RG, GL_FLOAT);
  }
  check_gl("drawing");
}

int largest_tile() {
  GLint texture = 0, viewport[2] = {};
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  return std::min({texture, viewport[0], viewport[1]});
}

int subpixel_bits() {
  GLint bits = 0;
  glGetIntegerv(GL_SUBPIXEL_BITS, &bits);
  return std::clamp(bits, 4, 16);
}

} // namespace domewarp
