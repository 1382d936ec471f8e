// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"

namespace domewarp::test_scenes {

/// 8-bit sRGB samples, first row on top; 3 channels, or 4 with alpha.
struct Picture {
  int width = 0, height = 0, channels = 3;
  std::vector<std::uint8_t> samples;
};

/// sRGB 0..1 and alpha of a picture at u, v in 0..1 from the top left.
using Painter = std::function<Vec4(double u, double v)>;

Vec4 rgb(std::uint32_t hex); ///< 0xRRGGBB
Vec4 mix(const Vec4& a, const Vec4& b, double t);
double ramp(double low, double high, double x); ///< smooth 0..1

/// Repeatable value noise in 0..1 that repeats every `period` cells.
double noise(double x, double y, int period, std::uint32_t seed);
/// 0..1, well mixed, the same for the same two numbers.
double random_at(int x, int y, std::uint32_t seed);
/// Four octaves of `noise`.
double clouds(double u, double v, int period, std::uint32_t seed);

/// The colour at each pixel's centre.
Picture paint(int width, int height, int channels, const Painter& painter);

Picture checker(int size, int fields, const Vec4& a, const Vec4& b);
/// Square tiles with joints, each a little different.
Picture tiles(int size, int count, const Vec4& a, const Vec4& b, const Vec4& joint);
Picture planks(int size, int count, const Vec4& light, const Vec4& dark, std::uint32_t seed);
Picture bricks(int size, const Vec4& brick, const Vec4& joint);
Picture speckled(int size, const Vec4& a, const Vec4& b, int period, std::uint32_t seed);
/// Cobbled together from cells with walls between them.
Picture cells(int size, int count, const Vec4& inside, const Vec4& wall, std::uint32_t seed);
Picture stripes(int size, const std::vector<Vec4>& colors);
Picture sky(int width, int height, const Vec4& zenith, const Vec4& horizon, const Vec4& cloud);
/// One of A-Z, 0-9 in a frame.
Picture letter(int size, char sign, const Vec4& ink, const Vec4& ground);
bool is_ink(char sign, double u, double v); ///< whether a 5 x 7 sign covers the point of its cell

} // namespace domewarp::test_scenes
