// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>

#include "domewarp/refine/error_bound.h"
#include "domewarp/refine/visible_region.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

/// What is known of one point of the mesh: where it is, on which side of each boundary, and where it appears.
struct MappedPoint : Direction {
  Sides sides{1, 1, 1};
  Mapped mapped;            ///< only where no side is -1
  std::uint8_t asked = 0;   ///< how many splits that a criterion asked for led to it
};

/// A point of an edge or face as it would be drawn without being a vertex: interpolated between those that are.
struct DrawnPoint : Direction {
  Vec2 image = Vec2(0);     ///< homogeneous: times weight
  double weight = 1;
  double depth = 0;         ///< perspective output: the weight; orthographic output: the distance
  double off = 0;           ///< distance between image and weight times the exact image
  double depth_off = 0;     ///< relative error of depth
  Mapped exact;             ///< where it belongs
};

/// The middle of a segment, its deviations unknown (0).
DrawnPoint halfway(const DrawnPoint& p, const DrawnPoint& q);

/// An edge that must be split, and the point that splits it.
struct Split {
  double t = 0.5;           ///< from the end that precedes
  MappedPoint point;
};

/// What was decided about an edge; `error` (image units) and `depth_error` bound the edge as it is.
struct EdgeDecision {
  std::optional<Split> split;
  float error = 0;
  float depth_error = 0;
  float excess = 0;         ///< of an edge that is split for its error: by how many times that, or the depth's, exceeds its tolerance
  float middle = -1;        ///< the error at the middle, image units, where it was measured
  float arch = 0;           ///< the error at t is at most 4 t (1 - t) arch, image units
  bool slides = false;      ///< kept by what holds inside a face (InnerPlane): error may exceed OracleOptions::tolerance
  float slide_depth = 0;    ///< of such an edge: bounds the relative error of the depth at what its points slide to
  bool certified = true;    ///< false where no bound helps (folds of the curve) and samples had to do: error, arch are sampled
  std::uint8_t evaluations = 0;
};

/// What an EdgeDecision tells a face of its side.
struct SideBound {
  double middle = -1, arch = 0;
  double depth = 0;         ///< EdgeDecision::depth_error
};

/// What judging faces took and found.
struct FaceJudgement {
  std::size_t evaluations = 0; ///< of the map
  double depth_error = 0;      ///< bound over the faces found good, relative
};

/// Inside one face of the source, where what it shows can slide along its plane without leaving its outline.
struct InnerPlane {
  double tolerance = 0;     ///< how far it may, image units
  double distance = 0;      ///< of the plane from the eye
};

/// What is known of an edge besides its ends.
struct EdgeContext {
  const EdgeBend* known = nullptr;    ///< what diagonal() found out about it, or null
  const InnerPlane* inside = nullptr; ///< of an edge inside one face of the source: what holds there, or null
};

/// Of an edge that is not in the mesh yet.
struct DiagonalBound {
  double error = 0;              ///< image units
  std::optional<EdgeBend> bend;  ///< none where an end has no image
};

/// Whether what is drawn on an edge asks for a vertex at its middle; `a` precedes `b`. A pure function of the two points,
/// called from many threads.
using EdgeCriterion = std::function<bool(const MappedPoint& a, const MappedPoint& b)>;

struct OracleOptions {
  double tolerance = 0;     ///< image units, for edges
  double face_tolerance = 0; ///< for faces, a little more: their bound can never fall below that of their sides
  double depth_tolerance = 0; ///< relative, for edges
  Projection projection = Projection::perspective;
  double face_depth_tolerance = std::numeric_limits<double>::infinity(); ///< relative, for faces
  EdgeCriterion criterion = {}; ///< asked when nothing else splits an edge; may be empty
  double criterion_length = 0; ///< edges whose images are not longer are not asked about, image units
  double turned_thickness = 0; ///< image units: thinner faces may appear turned over
  double texture_tolerance = 0, plain_tolerance = 0; ///< image units, inside faces: see RefineOptions; not above tolerance: none
};

/// Everything decided about an edge is decided here, from its two end points alone, in the order given by `precedes`.
/// In this order: split where it crosses a boundary; split where it dips across one and back; leave it when it is
/// outside; split at the angle's bisector beyond 60 degrees; split while the error bound exceeds the tolerance, an
/// edge that needs n pieces at floor(n / 2) / n of its angle; split at the midpoint while a criterion of the caller's asks for it.
class EdgeOracle {
public:
  EdgeOracle(const Surface& surface, std::size_t branch, const BranchMap& map, VisibleRegion region,
             const OracleOptions& options);

  /// @param a precedes b
  EdgeDecision decide(const MappedPoint& a, const MappedPoint& b, const EdgeContext& context = {}) const;

  /// What holds inside a face of the source; none where that is the same as on its outline, or the face is too thin to have a plane.
  std::optional<InnerPlane> inner_plane(const Vec3& a, const Vec3& b, const Vec3& c, bool is_plain) const;

  /// Whether a figure is so small and so well inside what the branch shows that no boundary can meet it.
  template <typename... Points>
  bool is_well_inside(double longest2, const Points&... corner) const {
    const double low = std::min({corner.u...}), high = std::max({corner.u...}), nearest = std::min({corner.rho...});
    return (... && (corner.sides[0] + corner.sides[1] + corner.sides[2] == 3)) && is_well_inside(longest2, low, high, nearest);
  }

  /// Sides and image of a point. `on`: index of a boundary it is known to lie on, or -1.
  MappedPoint locate(const Vec3& eye, int on = -1) const;

  /// The middle of an edge that nothing else asks to split; none where it would coincide with an end or be clipped.
  std::optional<MappedPoint> middle(const MappedPoint& a, const MappedPoint& b) const;

  /// Bounds of an edge that is not in the mesh yet, without evaluating the map: for choosing diagonals.
  /// @param a precedes b
  DiagonalBound diagonal(const MappedPoint& a, const MappedPoint& b) const;

  /// Whether the bounds of a face's error and depth error, all of it, are within the tolerances.
  /// @param side k is between corners k and k + 1
  /// @param depth it is judged in 4^depth parts at most
  bool is_good(const std::array<const MappedPoint*, 3>& corner, const std::array<SideBound, 3>& side, int depth, FaceJudgement& judgement) const;

  /// Whether a face inside one of the source is within what holds there, its depth where its points slide to included.
  bool may_slide(const std::array<const MappedPoint*, 3>& corner, const std::array<SideBound, 3>& side, const InnerPlane& inside, int depth, FaceJudgement& judgement) const;

  /// See ErrorBound. No edge within a figure whose second / (8 weight_low) and depth are within the tolerances is split for its error.
  EdgeBend short_segments(const ShortSegments& segments) const { return bound_.short_segments(segments); }

  /// Distance between the exact image of a point, barycentric `weights`, and its interpolation, image units.
  double interior_error(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& weights) const;
  /// The relative error of its interpolated depth.
  double interior_depth_error(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, const Vec3& weights) const;

  /// Whether a face is within a tolerance (image units) and that of its depth at four points inside: for faces that no bound
  /// can prove good.
  bool looks_good(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c, double tolerance, FaceJudgement& judgement) const;

  /// The same with every tolerance, thickness, and the least length that the criterion is asked about, times `factor`.
  EdgeOracle relaxed(double factor) const;

  int orientation() const { return map_.branch().orientation; }
  /// Whether R' grows without bound towards an end of the branch: where a bound proves nothing there, samples decide.
  bool has_fold() const { return map_.branch().fold_low || map_.branch().fold_high; }
  const VisibleRegion& region() const { return region_; }
  const OracleOptions& options() const { return options_; }

private:
  struct FaceLimits {
    double error, depth_error; ///< image units; relative
  };

  /// What is known of the parts of a face.
  struct FaceParts {
    Vec3 seconds;           ///< bound the second derivatives along the sides and the segments parallel to them
    int depth = 1;          ///< each is judged in 4^(depth - 1) parts at most
    bool has_depth = false; ///< whether the depth of the whole face is known to be good
    FaceLimits limits;
  };

  /// A face with its corners in canonical order and what bounds all of it.
  struct SortedFace {
    std::array<const MappedPoint*, 3> corner;
    std::array<SideBound, 3> side; ///< k from corner k to k + 1
    Vec3 second;                   ///< FaceBend::second
    double error, depth_error;     ///< image units; relative
  };
  bool is_within(const SortedFace& face, const FaceLimits& limits, int depth, FaceJudgement& judgement) const;
  SortedFace bound_of(const std::array<const MappedPoint*, 3>& corner, const std::array<SideBound, 3>& side) const;

  /// Bounds of what is drawn between two points: of the second derivative along, of the error, of the depth's.
  struct Piece {
    double second, error, depth;
  };

  bool is_well_inside(double longest2, double u_low, double u_high, double nearest) const;
  Mapped map_point(const Vec3& eye) const;
  std::optional<Split> split_at_boundary(const MappedPoint& a, const MappedPoint& b, bool& outside) const;
  bool is_sagging_chord(const MappedPoint& a, const MappedPoint& b) const;
  bool are_parts_good(const std::array<DrawnPoint, 3>& corner, const std::array<DrawnPoint, 3>& middle, const FaceParts& parts, FaceJudgement& judgement) const;
  bool is_part_good(const std::array<DrawnPoint, 3>& corner, FaceParts parts, FaceJudgement& judgement) const;
  double image_extent(const MappedPoint& a, const MappedPoint& b, const Vec2& middle) const;
  DrawnPoint drawn(const MappedPoint& p) const;
  DrawnPoint between(const DrawnPoint& p, const DrawnPoint& q) const; ///< one evaluation
  MappedPoint vertex_at(const DrawnPoint& p) const; ///< p must know where it belongs
  Piece piece(const DrawnPoint& p, const DrawnPoint& q) const;
  double slid_depth(const Range& span, double farthest, double error, double depth_error, const InnerPlane& inside) const;
  Split share_out(const MappedPoint& a, const MappedPoint& b, const DrawnPoint& middle, double excess, std::uint8_t& evaluations) const;
  EdgeDecision split_by_criterion(EdgeDecision decision, const MappedPoint& a, const MappedPoint& b) const;
  EdgeDecision split_by_error(const MappedPoint& a, const MappedPoint& b, const EdgeContext& context) const;
  EdgeDecision split_by_samples(const MappedPoint& a, const MappedPoint& b) const;

  const BranchMap& map_;
  VisibleRegion region_;
  OracleOptions options_;
  ErrorBound bound_;
  double u_low_, u_high_, nearest_; ///< the boundaries, infinite where there is none
  int most_asked_ = 0;      ///< the criterion is not asked about ends that took so many of its splits
  double rim_angle_;        ///< how far (radians) an edge may dip across a cone unnoticed
  double low_slope_, high_slope_; ///< |R'| at the ends of the branch, 0 at a fold
};

} // namespace domewarp
