// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/scene/image.h"

namespace domewarp {

/// sRGB red, green, blue and how much it covers.
struct Ink {
  std::uint8_t red = 0, green = 0, blue = 0;
  double opacity = 1;
};

enum class Align { left, centre, right };

/// An opaque picture that lines, areas, text and other pictures are drawn on, antialiased. Coordinates are pixels,
/// x to the right and y down from the top left corner.
class Canvas {
 public:
  /// @throws Error(output) when there is no memory for it
  Canvas(int width, int height, const Ink& background);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Draws a picture into the rectangle, averaged where it is made smaller.
  void picture(const Pixels& pixels, double left, double top, double width, double height);
  void line(const std::vector<Vec2>& points, const Ink& ink, double width);
  void area(const std::vector<Vec2>& points, const Ink& ink);
  void rectangle(double left, double top, double width, double height, const Ink& ink);
  void ring(const Vec2& centre, double radius, const Ink& ink, double width);
  /// @param y of the baseline; @param size of the font, px
  void text(double x, double y, double size, const std::string& text, const Ink& ink, Align align = Align::left);

  Pixels pixels() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The picture with `width` columns, averaged; as it is when that is not smaller.
Pixels shrink(const Pixels& pixels, int width);

} // namespace domewarp
