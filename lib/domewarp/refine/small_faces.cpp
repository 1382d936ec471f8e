// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/small_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"
#include "domewarp/core/rounding.h"
#include "domewarp/profile/half_angle.h"
#include "domewarp/refine/flips.h"

namespace domewarp {

namespace {

constexpr std::size_t block_size = 4096;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// By how much stricter a face is judged than an edge, so that rounding cannot tell them apart the wrong way.
constexpr double strictness = 0.99;

/// sum over i < j of 4 l_i l_j is at most this for barycentric l: what a face is off by, against its sides.
constexpr double face_over_edge = 4.0 / 3.0;

struct Verdict {
  FaceFate fate = FaceFate::refine;
  float error = 0, depth_error = 0;
  bool off_picture = false;
};

class Sieve {
public:
  Sieve(const EdgeOracle& oracle, const LevelOptions& options) : oracle_(oracle), options_(options), thickness_(oracle.options().turned_thickness) {
    for (std::size_t i = 0; i < oracle.region().boundaries.size(); ++i) {
      const Boundary& boundary = oracle.region().boundaries[i];
      if (boundary.kind == Boundary::Kind::near_sphere) {
        nearest_ = boundary.radius;
        continue;
      }
      const bool is_high = boundary.kind == Boundary::Kind::high_cone;
      (is_high ? u_high_ : u_low_) = half_angle_index(boundary.sine, boundary.cosine, 1);
      (is_high ? high_ : low_) = static_cast<int>(i);
    }
  }

  Verdict judge(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c) const {
    const std::array<const MappedPoint*, 3> corner{&a, &b, &c};
    const auto [u_low, u_high] = std::minmax({a.u, b.u, c.u});
    const auto length2 = [](const MappedPoint& p, const MappedPoint& q) { return glm::dot(p.eye - q.eye, p.eye - q.eye); };
    const double longest = std::sqrt(std::max({length2(a, b), length2(b, c), length2(c, a)})), nearest = std::min({a.rho, b.rho, c.rho});
    const double angle = small_angle(longest, nearest), margin = u_margin(angle);
    if (!(angle < infinity)) return {};
    const auto all = [&](int boundary, int side) {
      return std::all_of(corner.begin(), corner.end(), [&](const MappedPoint* p) { return p->sides[boundary] == side; });
    };
    if ((u_low - margin > u_high_ && all(high_, -1)) || (u_high + margin < u_low_ && all(low_, -1))) return {FaceFate::drop};
    if (!options_.small_faces || u_low - margin < u_low_ || u_high + margin > u_high_ || nearest - longest <= nearest_) return {};
    for (int i = 0; i < 3; ++i)
      if (!all(i, 1)) return {};
    if (is_asked_for(corner) || is_flipped(corner, oracle_.orientation(), thickness_)) return {};
    const auto [lightest, heaviest] = std::minmax({a.mapped.weight, b.mapped.weight, c.mapped.weight});
    const EdgeBend bend = oracle_.short_segments({angle, u_low, u_high, lightest, heaviest});
    const double error = bend.second / (8 * lightest);
    const OracleOptions& limits = oracle_.options();
    if (!(error <= strictness * limits.tolerance && face_over_edge * error <= limits.face_tolerance && bend.depth <= strictness * limits.depth_tolerance &&
          face_over_edge * bend.depth <= strictness * limits.face_depth_tolerance))
      return {};
    if (options_.cull != nullptr && !options_.cull->straddles(a, b, c)) return {FaceFate::drop, 0, 0, true};
    return {FaceFate::whole, rounded_up(error), rounded_up(face_over_edge * bend.depth)};
  }

private:
  /// Whether the criterion could ask about a side.
  bool is_asked_for(const std::array<const MappedPoint*, 3>& corner) const {
    const OracleOptions& options = oracle_.options();
    if (!options.criterion) return false;
    for (int k = 0; k < 3; ++k)
      if (glm::length(corner[(k + 1) % 3]->mapped.image - corner[k]->mapped.image) > options.criterion_length) return true;
    return false;
  }

  const EdgeOracle& oracle_;
  const LevelOptions& options_;
  double thickness_;
  double u_low_ = -infinity, u_high_ = infinity, nearest_ = 0;
  int low_ = 0, high_ = 0; ///< which boundaries these are
};

struct Block {
  std::vector<std::uint32_t> refine;
  std::vector<WholeFace> whole;
  float depth_error = 0;
  std::size_t clipped = 0, off_picture = 0;
};

} // namespace

SiftedFaces sift_faces(const Soup& soup, std::span<const MappedPoint> points, const EdgeOracle& oracle, const LevelOptions& options) {
  const Sieve sieve(oracle, options);
  SiftedFaces sifted;
  sifted.fate.resize(soup.faces.size());
  std::vector<Block> blocks((soup.faces.size() + block_size - 1) / block_size);
  parallel_each(blocks.size(), 1, [&](std::size_t i) {
    Block& block = blocks[i];
    const std::size_t end = std::min(soup.faces.size(), (i + 1) * block_size);
    for (std::size_t f = i * block_size; f < end; ++f) {
      const Triangle point = points_of(soup, soup.faces[f]);
      const MappedPoint &a = points[point[0]], &b = points[point[1]], &c = points[point[2]];
      Verdict verdict = sieve.judge(a, b, c);
      if (verdict.fate == FaceFate::refine && options.cull != nullptr && !options.cull->may_be_seen(a, b, c)) verdict = {FaceFate::drop, 0, 0, true};
      sifted.fate[f] = verdict.fate;
      block.depth_error = std::max(block.depth_error, verdict.depth_error);
      if (verdict.fate == FaceFate::refine)
        block.refine.push_back(static_cast<std::uint32_t>(f));
      else if (verdict.fate == FaceFate::whole)
        block.whole.push_back({static_cast<std::uint32_t>(f), verdict.error});
      else
        ++(verdict.off_picture ? block.off_picture : block.clipped);
    }
  });
  std::size_t refine = 0, whole = 0;
  for (const Block& block : blocks) {
    refine += block.refine.size();
    whole += block.whole.size();
  }
  sifted.refine.reserve(refine);
  sifted.whole.reserve(whole);
  for (const Block& block : blocks) {
    sifted.refine.insert(sifted.refine.end(), block.refine.begin(), block.refine.end());
    sifted.whole.insert(sifted.whole.end(), block.whole.begin(), block.whole.end());
    sifted.depth_error = std::max(sifted.depth_error, block.depth_error);
    sifted.clipped += block.clipped;
    sifted.off_picture += block.off_picture;
  }
  return sifted;
}

} // namespace domewarp
