// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/test_scenes/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace domewarp::test_scenes {

Vec4 rgb(std::uint32_t hex) {
  return {(hex >> 16 & 255) / 255.0, (hex >> 8 & 255) / 255.0, (hex & 255) / 255.0, 1};
}

Vec4 mix(const Vec4& a, const Vec4& b, double t) {
  return a + (b - a) * t;
}

double ramp(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

namespace {

/// Lowbias32 of Chris Wellons: every input bit reaches every output bit.
std::uint32_t scramble(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return x ^ x >> 16;
}

double lattice(int x, int y, int period, std::uint32_t seed) {
  return random_at((x % period + period) % period, (y % period + period) % period, seed);
}

} // namespace

double random_at(int x, int y, std::uint32_t seed) {
  return scramble(static_cast<std::uint32_t>(x) + scramble(static_cast<std::uint32_t>(y) + scramble(seed))) /
         4294967296.0;
}

double noise(double x, double y, int period, std::uint32_t seed) {
  const double fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const double tx = ramp(0, 1, x - fx), ty = ramp(0, 1, y - fy);
  const auto row = [&](int j) {
    const double a = lattice(ix, j, period, seed);
    return a + (lattice(ix + 1, j, period, seed) - a) * tx;
  };
  return row(iy) + (row(iy + 1) - row(iy)) * ty;
}

double clouds(double u, double v, int period, std::uint32_t seed) {
  double sum = 0, weight = 0.5;
  for (int octave = 0; octave < 4; ++octave, weight *= 0.5, period *= 2)
    sum += weight * noise(u * period, v * period, period, seed + static_cast<std::uint32_t>(octave));
  return sum / 0.9375;
}

Picture paint(int width, int height, int channels, const Painter& painter) {
  Picture picture{width, height, channels, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec4 color = painter((x + 0.5) / width, (y + 0.5) / height);
      for (int i = 0; i < channels; ++i)
        picture.samples.push_back(static_cast<std::uint8_t>(std::floor(std::clamp(color[i], 0.0, 1.0) * 255 + 0.5)));
    }
  return picture;
}

Picture checker(int size, int fields, const Vec4& a, const Vec4& b) {
  return paint(size, size, 3, [&](double u, double v) {
    const int field = static_cast<int>(u * fields) + static_cast<int>(v * fields);
    return field % 2 ? b : a;
  });
}

Picture tiles(int size, int count, const Vec4& a, const Vec4& b, const Vec4& joint) {
  return paint(size, size, 3, [&](double u, double v) {
    const double x = u * count, y = v * count;
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    const double edge = std::min({x - ix, ix + 1 - x, y - iy, iy + 1 - y});
    const Vec4 base = mix((ix + iy) % 2 ? b : a, Vec4(0.5), 0.16 * lattice(ix, iy, count, 5));
    const double marble = 0.9 + 0.16 * clouds(u, v, 8, 17);
    return edge < 0.02 ? joint : base * marble;
  });
}

Picture planks(int size, int count, const Vec4& light, const Vec4& dark, std::uint32_t seed) {
  return paint(size, size, 3, [&](double u, double v) {
    const double y = v * count;
    const int plank = static_cast<int>(y);
    const double offset = lattice(plank, 0, count, seed), along = u + offset - std::floor(u + offset);
    const double grain = noise(along * 8, v * 8 * count, 8 * count, seed + 1) * 0.6 +
                         noise(along * 4, v * 32 * count, 32 * count, seed + 2) * 0.4;
    const bool is_joint = std::min(y - plank, plank + 1 - y) < 0.02 || along < 0.006;
    return mix(light, dark, is_joint ? 1.25 : 0.65 * grain + 0.3 * lattice(plank, 1, count + 1, seed));
  });
}

Picture bricks(int size, const Vec4& brick, const Vec4& joint) {
  return paint(size, size, 3, [&](double u, double v) {
    const int row = static_cast<int>(v * 8);
    const double x = u * 4 + 0.5 * (row % 2);
    const int column = static_cast<int>(x) % 4;
    const double dx = x - std::floor(x), dy = v * 8 - row;
    const bool is_joint = std::min(dx, 1 - dx) * 2 < 0.06 || std::min(dy, 1 - dy) < 0.06;
    return (is_joint ? joint : brick * (0.8 + 0.3 * lattice(column, row, 8, 3))) * (0.9 + 0.2 * clouds(u, v, 16, 9));
  });
}

Picture speckled(int size, const Vec4& a, const Vec4& b, int period, std::uint32_t seed) {
  return paint(size, size, 3, [&](double u, double v) { return mix(a, b, clouds(u, v, period, seed)); });
}

namespace {

/// The distances to the nearest and the second nearest of a field of points, one in each unit square.
Vec2 nearest_two(double x, double y, int period, std::uint32_t seed) {
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  Vec2 best(9);
  for (int j = iy - 1; j <= iy + 1; ++j)
    for (int i = ix - 1; i <= ix + 1; ++i) {
      const double dx = i + 0.15 + 0.7 * lattice(i, j, period, seed) - x;
      const double dy = j + 0.15 + 0.7 * lattice(i, j, period, seed + 1) - y;
      const double d = std::sqrt(dx * dx + dy * dy);
      best = d < best.x ? Vec2(d, best.x) : Vec2(best.x, std::min(best.y, d));
    }
  return best;
}

} // namespace

Picture cells(int size, int count, const Vec4& inside, const Vec4& wall, std::uint32_t seed) {
  return paint(size, size, 3, [&](double u, double v) {
    const Vec2 d = nearest_two(u * count, v * count, count, seed);
    const Vec4 shaded = mix(inside, wall, ramp(0.45, 0.1, d.y - d.x));
    return shaded * (0.85 + 0.3 * ramp(0.14, 0.24, d.x)) * (0.9 + 0.2 * clouds(u, v, 16, seed));
  });
}

Picture stripes(int size, const std::vector<Vec4>& colors) {
  return paint(size, 8, 3, [&](double u, double) {
    return colors[static_cast<std::size_t>(u * static_cast<double>(colors.size()))];
  });
}

Picture sky(int width, int height, const Vec4& zenith, const Vec4& horizon, const Vec4& cloud) {
  return paint(width, height, 3, [&](double u, double v) {
    const double cover = ramp(0.48, 0.8, clouds(u, v, 4, 29)) * ramp(0, 0.3, v);
    return mix(mix(zenith, horizon, ramp(0, 1, v)), cloud, cover);
  });
}

namespace {

struct Sign {
  char name;
  std::array<std::uint8_t, 7> rows; ///< 5 bits each, the highest is on the left
};

constexpr std::array<Sign, 36> signs = {{
    {'A', {0x0e, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11}}, {'B', {0x1e, 0x11, 0x11, 0x1e, 0x11, 0x11, 0x1e}},
    {'C', {0x0e, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0e}}, {'D', {0x1e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x1e}},
    {'E', {0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x1f}}, {'F', {0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x10}},
    {'G', {0x0e, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0f}}, {'H', {0x11, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11}},
    {'I', {0x0e, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e}}, {'J', {0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0c}},
    {'K', {0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11}}, {'L', {0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1f}},
    {'M', {0x11, 0x1b, 0x15, 0x15, 0x11, 0x11, 0x11}}, {'N', {0x11, 0x19, 0x15, 0x13, 0x11, 0x11, 0x11}},
    {'O', {0x0e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e}}, {'P', {0x1e, 0x11, 0x11, 0x1e, 0x10, 0x10, 0x10}},
    {'Q', {0x0e, 0x11, 0x11, 0x11, 0x15, 0x12, 0x0d}}, {'R', {0x1e, 0x11, 0x11, 0x1e, 0x14, 0x12, 0x11}},
    {'S', {0x0f, 0x10, 0x10, 0x0e, 0x01, 0x01, 0x1e}}, {'T', {0x1f, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04}},
    {'U', {0x11, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e}}, {'V', {0x11, 0x11, 0x11, 0x11, 0x11, 0x0a, 0x04}},
    {'W', {0x11, 0x11, 0x11, 0x15, 0x15, 0x15, 0x0a}}, {'X', {0x11, 0x11, 0x0a, 0x04, 0x0a, 0x11, 0x11}},
    {'Y', {0x11, 0x11, 0x0a, 0x04, 0x04, 0x04, 0x04}}, {'Z', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1f}},
    {'0', {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e}}, {'1', {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e}},
    {'2', {0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f}}, {'3', {0x1e, 0x01, 0x01, 0x0e, 0x01, 0x01, 0x1e}},
    {'4', {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02}}, {'5', {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e}},
    {'6', {0x0e, 0x10, 0x10, 0x1e, 0x11, 0x11, 0x0e}}, {'7', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}},
    {'8', {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e}}, {'9', {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x01, 0x0e}},
}};

} // namespace

bool is_ink(char name, double u, double v) {
  if (u < 0 || u >= 1 || v < 0 || v >= 1) return false;
  const auto sign = std::find_if(signs.begin(), signs.end(), [name](const Sign& s) { return s.name == name; });
  if (sign == signs.end()) return false;
  return sign->rows[static_cast<std::size_t>(v * 7)] >> (4 - static_cast<int>(u * 5)) & 1;
}

Picture letter(int size, char sign, const Vec4& ink, const Vec4& ground) {
  return paint(size, size, 3, [&](double u, double v) {
    const double edge = std::min({u, 1 - u, v, 1 - v});
    const bool is_frame = edge > 0.06 && edge < 0.11;
    return is_frame || is_ink(sign, (u - 0.26) / 0.48, (v - 0.2) / 0.6) ? ink : ground;
  });
}

} // namespace domewarp::test_scenes
