// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "domewarp/profile/surface.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

/// Coordinates of points: three arrays (stride 1), or one of x y z x y z ... (y = x + 1, z = x + 2, stride 3).
struct ConstPoints {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
  std::size_t stride = 1; ///< 1 or 3
};
struct Points {
  float* x = nullptr;
  float* y = nullptr;
  float* z = nullptr;
  std::size_t stride = 1;
  operator ConstPoints() const { return {x, y, z, stride}; }
};
/// x y z x y z ...; null for no points at all.
inline ConstPoints interleaved(const float* xyz) { return xyz ? ConstPoints{xyz, xyz + 1, xyz + 2, 3} : ConstPoints{}; }
inline Points interleaved(float* xyz) { return xyz ? Points{xyz, xyz + 1, xyz + 2, 3} : Points{}; }

/// Points from which on a table in single precision pays: it is built in 13 to 140 microseconds, median 40, and the direct method
/// takes 0.2 to 0.4 for a point (measured: `domewarp-bench map`).
inline constexpr std::size_t float_table_pays_from = 150;

enum class BatchOutput {
  image,       ///< x', y', depth = |p|
  /// w x', w y', -w with w = |p| g(theta), for a perspective camera of 90 degrees. g is BranchMap's to 0.3 %: any smooth
  /// positive weight draws the same points, but a mesh must take all its vertices from one map.
  perspective,
};

struct BatchOptions {
  /// Automatic: a float table from `float_table_pays_from` points on; where there is none, as BranchMap does.
  Method method = Method::automatic;
  /// Predicted error of x' and y' that the table may have, image units (0.01 pixels of 4096 rows); tables grow until it
  /// is a fifth of that.
  double max_error = 5e-6;
  std::size_t points = many_points; ///< how many will be mapped
};

struct BatchReport {
  bool vectorised = false;    ///< false: points are mapped one by one in double precision
  bool direct = false;        ///< not vectorised, and at least one branch has no table
  TableReason reason = TableReason::used; ///< why it is direct
  int pieces = 0, degree = 0; ///< of the float table
  double predicted_error = 0; ///< of x' and y', image units
  double weight_error = 0;    ///< relative, of the weight g
  double build_ms = 0;
};

/// The map of whole arrays of single-precision points: at the speed of a copy where the surface is one branch that rises
/// from the axis and a float table of it is exact enough, else point by point. What a point maps to depends on nothing
/// but the point: not on its place in the array, nor on how that is laid out.
/// Safe to share between threads. Keeps what it needs of the surface.
class BatchMap {
public:
  explicit BatchMap(const Surface& surface, const BatchOptions& options = {});
  ~BatchMap();
  BatchMap(BatchMap&&) noexcept;
  BatchMap& operator=(BatchMap&&) noexcept;

  const BatchReport& report() const;

  /// Maps eye-space points (looking along -z) to `output`. A direction beyond the rim follows the tangent extension; a
  /// blind point is put 1e4 image units from the centre in its direction, as is what the extension would put farther
  /// out. The eye itself and points that are not finite become nan. A depth beyond the range of float is infinite.
  /// @param in, out `count` points each; must not overlap. In parallel.
  void map(const ConstPoints& in, const Points& out, std::size_t count, BatchOutput output) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

} // namespace domewarp
