// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/gl_context.h"

#include <array>
#include <utility>
#include <vector>

#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include "domewarp/core/errors.h"

namespace domewarp {

namespace {

/// Mesa's own platform first (it finds the GPU's render node itself and falls back to software), then every device.
std::vector<EGLDisplay> list_displays() {
  std::vector<EGLDisplay> displays;
  const auto platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  const auto query_devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  if (!platform_display) return displays;
  displays.push_back(platform_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr));
  std::array<EGLDeviceEXT, 16> devices{};
  EGLint count = 0;
  if (!query_devices || !query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count)) return displays;
  for (std::size_t i = 0; i < std::size_t(count); ++i)
    displays.push_back(platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
  return displays;
}

/// Null when the display has no OpenGL 4.5 core or cannot do without a surface.
EGLContext make_context(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return EGL_NO_CONTEXT;
  if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display, wanted, &config, 1, &count) || count < 1) return EGL_NO_CONTEXT;
  const EGLint version[] = {
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
  if (context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return context;
  if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  return EGL_NO_CONTEXT;
}

GlObject compile(GLenum kind, const char* source) {
  GlObject shader(glCreateShader(kind), [](unsigned name) { glDeleteShader(name); });
  glShaderSource(shader.name(), 1, &source, nullptr);
  glCompileShader(shader.name());
  GLint done = 0;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &done);
  if (done) return shader;
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader.name(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw Error(ErrorCode::output, std::string("OpenGL: the driver refuses a shader: ") + log.data());
}

} // namespace

GlContext::GlContext() {
  for (const EGLDisplay display : list_displays()) {
    display_ = display;
    context_ = make_context(display);
    if (context_ != EGL_NO_CONTEXT) break;
  }
  if (context_ == EGL_NO_CONTEXT)
    throw Error(ErrorCode::output, "EGL: no device gives an OpenGL 4.5 core context without a window");
  driver_ = std::string(reinterpret_cast<const char*>(glGetString(GL_RENDERER))) + ", " +
            reinterpret_cast<const char*>(glGetString(GL_VERSION));
}

// The display stays initialised: other threads may have contexts on the same one.
GlContext::~GlContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglReleaseThread();
}

GlObject& GlObject::operator=(GlObject&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(destroy_, other.destroy_);
  return *this;
}

GlObject::~GlObject() {
  if (name_ && destroy_) destroy_(name_);
}

GlObject make_buffer() {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  return {name, [](unsigned n) { glDeleteBuffers(1, &n); }};
}

GlObject make_framebuffer() {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  return {name, [](unsigned n) { glDeleteFramebuffers(1, &n); }};
}

GlObject make_texture() {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  return {name, [](unsigned n) { glDeleteTextures(1, &n); }};
}

GlObject make_vertex_array() {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  return {name, [](unsigned n) { glDeleteVertexArrays(1, &n); }};
}

GlObject make_program(const char* vertex_shader, const char* fragment_shader) {
  const GlObject vertex = compile(GL_VERTEX_SHADER, vertex_shader);
  const GlObject fragment = compile(GL_FRAGMENT_SHADER, fragment_shader);
  GlObject program(glCreateProgram(), [](unsigned name) { glDeleteProgram(name); });
  glAttachShader(program.name(), vertex.name());
  glAttachShader(program.name(), fragment.name());
  glLinkProgram(program.name());
  GLint done = 0;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &done);
  if (done) return program;
  std::array<char, 1024> log{};
  glGetProgramInfoLog(program.name(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw Error(ErrorCode::output, std::string("OpenGL: the driver refuses to link the shaders: ") + log.data());
}

void check_gl(const std::string& what) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  throw Error(ErrorCode::output, "OpenGL: " + what + " failed (" +
                                     (error == GL_OUT_OF_MEMORY ? "out of memory" : "error " + std::to_string(error)) +
                                     ")");
}

} // namespace domewarp
