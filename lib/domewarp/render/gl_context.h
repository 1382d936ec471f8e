// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace domewarp {

/// A headless OpenGL 4.5 core context, current on the calling thread while the object lives.
class GlContext {
 public:
  /// @throws Error(output) when no EGL device gives such a context
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// The driver's own name and version, such as "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6".
  const std::string& driver() const { return driver_; }

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
  std::string driver_;
};

/// An OpenGL object: its name, and the function that deletes it.
class GlObject {
 public:
  using Delete = void (*)(unsigned);
  GlObject() = default;
  GlObject(unsigned name, Delete destroy) : name_(name), destroy_(destroy) {}
  GlObject(GlObject&& other) noexcept : name_(other.name_), destroy_(other.destroy_) { other.name_ = 0; }
  GlObject& operator=(GlObject&& other) noexcept;
  ~GlObject();

  unsigned name() const { return name_; }

 private:
  unsigned name_ = 0;
  Delete destroy_ = nullptr;
};

GlObject make_buffer();
GlObject make_framebuffer();
GlObject make_texture();
GlObject make_vertex_array();

/// @throws Error(output) with the compiler's message
GlObject make_program(const char* vertex_shader, const char* fragment_shader);

/// @throws Error(output) naming what was being done when OpenGL has noted an error
void check_gl(const std::string& what);

} // namespace domewarp
