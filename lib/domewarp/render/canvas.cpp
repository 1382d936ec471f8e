// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/canvas.h"

#include <cmath>
#include <numbers>
#include <algorithm>

#include <cairo.h>

#include "domewarp/core/errors.h"

namespace domewarp {

namespace {

struct SurfaceDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct ContextDeleter {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Picture = std::unique_ptr<cairo_surface_t, SurfaceDeleter>;
using Context = std::unique_ptr<cairo_t, ContextDeleter>;

Picture make_picture(int width, int height) {
  Picture picture(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  if (cairo_surface_status(picture.get()) != CAIRO_STATUS_SUCCESS)
    throw Error(ErrorCode::output, "picture of " + std::to_string(width) + "x" + std::to_string(height) + ": " +
                                       cairo_status_to_string(cairo_surface_status(picture.get())));
  return picture;
}

/// Over black where it is transparent.
Picture make_picture(const Pixels& pixels) {
  Picture picture = make_picture(pixels.width, pixels.height);
  std::uint8_t* const rows = cairo_image_surface_get_data(picture.get());
  const int stride = cairo_image_surface_get_stride(picture.get());
  for (int y = 0; y < pixels.height; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(rows + std::ptrdiff_t(y) * stride);
    for (int x = 0; x < pixels.width; ++x) {
      const std::uint8_t* p = &pixels.rgba[4 * (std::size_t(y) * std::size_t(pixels.width) + std::size_t(x))];
      const auto over_black = [p](int k) { return std::uint32_t(p[k]) * p[3] / 255; };
      row[x] = over_black(0) << 16 | over_black(1) << 8 | over_black(2);
    }
  }
  cairo_surface_mark_dirty(picture.get());
  return picture;
}

} // namespace

struct Canvas::Impl {
  Picture picture;
  Context context;

  void use(const Ink& ink) const {
    cairo_set_source_rgba(context.get(), ink.red / 255.0, ink.green / 255.0, ink.blue / 255.0, ink.opacity);
  }
  void trace(const std::vector<Vec2>& points) const {
    cairo_new_path(context.get());
    for (const Vec2& p : points) cairo_line_to(context.get(), p.x, p.y);
  }
};

Canvas::Canvas(int width, int height, const Ink& background) : impl_(std::make_unique<Impl>()) {
  impl_->picture = make_picture(width, height);
  impl_->context.reset(cairo_create(impl_->picture.get()));
  cairo_select_font_face(impl_->context.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_line_join(impl_->context.get(), CAIRO_LINE_JOIN_ROUND);
  impl_->use(background);
  cairo_paint(impl_->context.get());
}

Canvas::~Canvas() = default;

void Canvas::picture(const Pixels& pixels, double left, double top, double width, double height) {
  cairo_t* const c = impl_->context.get();
  const Picture source = make_picture(pixels);
  cairo_save(c);
  cairo_translate(c, left, top);
  cairo_scale(c, width / pixels.width, height / pixels.height);
  cairo_set_source_surface(c, source.get(), 0, 0);
  cairo_pattern_set_extend(cairo_get_source(c), CAIRO_EXTEND_PAD);
  cairo_pattern_set_filter(cairo_get_source(c), width > pixels.width ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
  cairo_rectangle(c, 0, 0, pixels.width, pixels.height);
  cairo_fill(c);
  cairo_restore(c);
}

void Canvas::line(const std::vector<Vec2>& points, const Ink& ink, double width) {
  impl_->trace(points);
  impl_->use(ink);
  cairo_set_line_width(impl_->context.get(), width);
  cairo_stroke(impl_->context.get());
}

void Canvas::area(const std::vector<Vec2>& points, const Ink& ink) {
  impl_->trace(points);
  impl_->use(ink);
  cairo_fill(impl_->context.get());
}

void Canvas::rectangle(double left, double top, double width, double height, const Ink& ink) {
  impl_->use(ink);
  cairo_rectangle(impl_->context.get(), left, top, width, height);
  cairo_fill(impl_->context.get());
}

void Canvas::ring(const Vec2& centre, double radius, const Ink& ink, double width) {
  impl_->use(ink);
  cairo_set_line_width(impl_->context.get(), width);
  cairo_new_path(impl_->context.get());
  cairo_arc(impl_->context.get(), centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
  cairo_stroke(impl_->context.get());
}

void Canvas::text(double x, double y, double size, const std::string& text, const Ink& ink, Align align) {
  cairo_t* const c = impl_->context.get();
  cairo_set_font_size(c, size);
  cairo_text_extents_t extents;
  cairo_text_extents(c, text.c_str(), &extents);
  const double shift = align == Align::left ? 0 : align == Align::right ? extents.x_advance : extents.x_advance / 2;
  impl_->use(ink);
  cairo_move_to(c, x - shift, y);
  cairo_show_text(c, text.c_str());
}

Pixels Canvas::pixels() const {
  cairo_surface_flush(impl_->picture.get());
  Pixels pixels;
  pixels.width = cairo_image_surface_get_width(impl_->picture.get());
  pixels.height = cairo_image_surface_get_height(impl_->picture.get());
  pixels.rgba.reserve(4 * std::size_t(pixels.width) * std::size_t(pixels.height));
  const std::uint8_t* const rows = cairo_image_surface_get_data(impl_->picture.get());
  const int stride = cairo_image_surface_get_stride(impl_->picture.get());
  for (int y = 0; y < pixels.height; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(rows + std::ptrdiff_t(y) * stride);
    for (int x = 0; x < pixels.width; ++x)
      for (const int shift : {16, 8, 0, 32})
        pixels.rgba.push_back(shift == 32 ? 255 : static_cast<std::uint8_t>(row[x] >> shift));
  }
  return pixels;
}

Pixels shrink(const Pixels& pixels, int width) {
  if (width >= pixels.width) return pixels;
  const int height = std::max(1, static_cast<int>(std::lround(double(pixels.height) * width / pixels.width)));
  Canvas canvas(width, height, {});
  canvas.picture(pixels, 0, 0, width, height);
  return canvas.pixels();
}

} // namespace domewarp
