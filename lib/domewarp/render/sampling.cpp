// SPDX-License-Identifier: Apache-2.0
//
// Based on: B. Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020, with the hash of S. Laine and T. Karras,
// 2011, and the constants of N. Vegdahl, 2021.
#include "domewarp/render/sampling.h"

namespace domewarp {

namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x >> 8) & 0x00ff00ffu);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Every bit is flipped or not by a hash of the bits above it: a random Owen scrambling.
std::uint32_t scramble(std::uint32_t x, std::uint32_t seed) {
  x = reverse_bits(x);
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return reverse_bits(x);
}

std::uint32_t mix(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

/// The second dimension of Sobol's sequence: direction numbers of the polynomial x + 1.
std::uint32_t sobol_second(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::uint32_t direction = 1u << 31; index; index >>= 1, direction ^= direction >> 1)
    if (index & 1) result ^= direction;
  return result;
}

} // namespace

Vec2 sobol_point(std::uint32_t index, std::uint32_t seed) {
  constexpr double unit = 1.0 / 4294967296.0;
  return {scramble(reverse_bits(index), mix(seed)) * unit, scramble(sobol_second(index), mix(seed ^ 0xa511e9b3u)) * unit};
}

std::uint32_t pixel_seed(int column, int row) {
  return mix(static_cast<std::uint32_t>(column) ^ mix(static_cast<std::uint32_t>(row) + 0x9e3779b9u));
}

} // namespace domewarp
