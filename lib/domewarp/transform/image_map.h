// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/profile/surface.h"

namespace domewarp {

/// How points are mapped. Automatic: by tables where at least `table_pays_from` points are mapped, else by the direct method.
enum class Method { automatic, direct, table };
const char* to_string(Method method); ///< "auto", "direct", "lut"

/// Points from which on building a table takes less time than it saves (measured: `domewarp-bench map`, "pays from":
/// 70 to 1200, median 500; tables in single precision are built in a fifth of the time).
inline constexpr std::size_t table_pays_from = 400;
inline constexpr std::size_t many_points = std::numeric_limits<std::size_t>::max();

enum class PointState { visible, extended, blind };
const char* to_string(PointState state);

/// An eye-space point on the image plane: x' = x K / rho, y' = y K / rho, depth = rho, K = R(theta) / sin(theta).
struct ImagePoint {
  double x = 0, y = 0;           ///< image units; nan for blind points
  double depth = 0;              ///< rho = |p|
  PointState state = PointState::visible;
};

/// The two functions of the view direction that warping needs.
struct RadialFactors {
  double k = 0;                  ///< K = R(theta) / sin(theta); R'(0) on the axis; large but finite straight behind
  double g = 1;                  ///< weight of perspective output, w = rho g: |R'(theta)|^(-1/2), kept within bounds
};

/// Why a table is used, or is not.
enum class TableReason {
  used,
  direct_asked, ///< Method::direct
  few_points,   ///< Method::automatic and fewer points than `table_pays_from`
  inexact,      ///< no table is within 1e-10 of the direct method
};
const char* to_string(TableReason reason);

/// How one branch was tabulated.
struct TableReport {
  bool used = false;             ///< false: the direct method answers
  TableReason reason = TableReason::direct_asked;
  int pieces = 0;
  int degree = 0;
  double max_error = 0;          ///< of R, image units, measured against the direct method
  double build_ms = 0;
};

/// The map of one branch from eye space to the image in double precision; a pure function of the direction, so that
/// equal positions give equal bits. Safe to share between threads.
/// Keeps what it needs of the surface, which need not outlive it.
class BranchMap {
public:
  /// Weight bounds: g = (q^2)^(-1/4) with q = |R'| / mean slope blended so that q stays within [epsilon, 1/epsilon],
  /// q^2 -> (q^2 + e^2) / (1 + q^2 e^2). Smooth, 1 where R' is constant.
  static constexpr double weight_epsilon = 0.05;

  /// @param points how many will be mapped, for Method::automatic
  BranchMap(const Surface& surface, std::size_t branch, Method method, std::size_t points = many_points);
  ~BranchMap();
  BranchMap(BranchMap&&) noexcept;
  BranchMap& operator=(BranchMap&&) noexcept;

  /// What is drawn of the branch (drawn_branch, transform/continuation.h).
  const Branch& branch() const;

  /// |R'| at an end of what is drawn, 0 at a fold.
  double end_slope(bool is_high) const;

  /// @param p eye space (looking along -z), finite and not zero; outside the branch R goes on from its nearer end
  ///          (transform/continuation.h).
  RadialFactors factors(const Vec3& p) const;

  /// Image point of p by this branch: (x, y) K / rho, up to rounding; a point straight behind, whose image is a circle,
  /// falls on its x axis.
  Vec2 image(const Vec3& p) const;

  /// Sines of theta minus the branch's ends, times |p|: > 0 inside (see clipping): {rho sin(theta - theta_low), rho
  /// sin(theta_high - theta)}. The first is +rho when theta_low is 0, the second +rho when theta_high is pi.
  Vec2 inside(const Vec3& p) const;

  /// The weight with its first two derivatives in theta, for error bounds (not bit-equal to factors()).
  Vec3 weight_jet(double theta) const;

  const TableReport& table() const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// All branches of a surface.
struct ImageMap {
  std::vector<BranchMap> branches;
};
ImageMap make_image_map(const Surface& surface, Method method, std::size_t points = many_points);

/// Where an eye-space point appears: on the first branch (nearest along the ray) that contains its direction, else by
/// the tangent extension, else blind. This is what `domewarp project` prints.
ImagePoint project(const Surface& surface, const ImageMap& map, const Vec3& p);

/// Unit eye-space direction seen at an image point; false beyond r_max. This is `domewarp project --inverse`.
bool unproject(const Surface& surface, const Vec2& image, Vec3& direction);

} // namespace domewarp
