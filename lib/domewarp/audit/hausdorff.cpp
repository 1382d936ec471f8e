// SPDX-License-Identifier: GPL-3.0-or-later
#include "domewarp/audit/hausdorff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Surface_mesh.h>
#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"

namespace domewarp {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Faces = CGAL::Surface_mesh<Kernel::Point_3>;

constexpr double depth_scale = 250;      ///< px
constexpr double boundary_margin = 1e-6;
constexpr double hidden_angle = 0.05;    ///< radians: a smaller piece of which no corner is shown is left out
constexpr int deepest = 14;              ///< halvings of a source triangle's sides
constexpr std::size_t most_pieces = 5'000'000;

/// Written positions in the space in which distances are taken.
class PictureSpace {
public:
  PictureSpace(const Drawn& drawn, const Picture& picture) : picture_(picture), px_(pixel_size(picture.raster)) {
    for (const Vec3& p : drawn.position) {
      nearest_ = std::min(nearest_, -p.z);
      farthest_ = std::max(farthest_, -p.z);
    }
  }

  Vec3 operator()(const Vec3& written) const {
    const double depth = -written.z, third = picture_.perspective ? nearest_ / depth : depth / farthest_;
    return Vec3(drawn_at(written, picture_.perspective) / px_, depth_scale * third);
  }

  /// Of an eye-space point, exactly.
  Vec3 exact(std::size_t branch, const Vec3& eye) const {
    const BranchMap& map = picture_.map.branches[branch];
    const double rho = glm::length(eye);
    const double depth = picture_.perspective ? rho * map.factors(eye).g : rho;
    const Vec2 image = map.image(eye);
    return (*this)(picture_.perspective ? Vec3(image * depth, -depth) : Vec3(image, -depth));
  }

private:
  const Picture& picture_;
  double px_, nearest_ = std::numeric_limits<double>::infinity(), farthest_ = 0;
};

/// Triangles that share nothing: distances need no more.
void add(Faces& mesh, const std::array<Vec3, 3>& corners) {
  std::array<Faces::Vertex_index, 3> ids;
  for (int k = 0; k < 3; ++k) ids[k] = mesh.add_vertex({corners[k].x, corners[k].y, corners[k].z});
  mesh.add_face(ids[0], ids[1], ids[2]);
}

/// Cuts source triangles in four until their sides' middles lie on their chords.
class ExactWarp {
public:
  ExactWarp(const Picture& picture, const PictureSpace& space, double flatness) : picture_(picture), space_(space), flatness_(flatness) {}

  void cut(std::size_t branch, const std::array<Vec3, 3>& eye, int level = 0) {
    std::array<bool, 3> shown{};
    for (int k = 0; k < 3; ++k) shown[k] = is_shown(picture_, branch, eye[k], boundary_margin);
    const bool whole = shown[0] && shown[1] && shown[2];
    std::array<Vec3, 3> middle, at{};
    for (int k = 0; k < 3; ++k) middle[k] = 0.5 * (eye[k] + eye[(k + 1) % 3]);
    if (whole) {
      double sag = 0;
      for (int k = 0; k < 3; ++k) at[k] = space_.exact(branch, eye[k]);
      for (int k = 0; k < 3; ++k) sag = std::max(sag, glm::length(space_.exact(branch, middle[k]) - 0.5 * (at[k] + at[(k + 1) % 3])));
      const double longest = std::max({glm::length(at[1] - at[0]), glm::length(at[2] - at[1]), glm::length(at[0] - at[2])});
      // A side that bends one way and back has its middle on its chord: long ones are cut in any case.
      if (level == deepest || (sag <= flatness_ && longest < 256)) return keep(at);
    } else if (level == deepest || is_within(eye, shown[0] || shown[1] || shown[2] ? 2 * pixel_size(picture_.raster) : hidden_angle)) {
      return;
    }
    cut(branch, {eye[0], middle[0], middle[2]}, level + 1);
    cut(branch, {middle[0], eye[1], middle[1]}, level + 1);
    cut(branch, {middle[2], middle[1], eye[2]}, level + 1);
    cut(branch, middle, level + 1);
  }

  const Faces& mesh() const { return mesh_; }

private:
  /// Whether the sides are seen under less than this angle.
  static bool is_within(const std::array<Vec3, 3>& eye, double angle) {
    for (int k = 0; k < 3; ++k)
      if (glm::length(eye[k] - eye[(k + 1) % 3]) > angle * std::min(glm::length(eye[k]), glm::length(eye[(k + 1) % 3]))) return false;
    return true;
  }

  void keep(const std::array<Vec3, 3>& corners) {
    if (mesh_.number_of_faces() >= most_pieces)
      throw Error(ErrorCode::usage, "--hausdorff: the exact warp needs more than " + std::to_string(most_pieces) + " pieces for this error; ask for a larger one");
    add(mesh_, corners);
  }

  const Picture& picture_;
  const PictureSpace& space_;
  double flatness_;
  Faces mesh_;
};

} // namespace

HausdorffReport measure_hausdorff(const Drawn& drawn, const Picture& picture, const SourceMesh& source, double error_px) {
  const PictureSpace space(drawn, picture);
  Faces warped;
  for (const Corners& t : drawn.triangles) add(warped, {space(drawn.position[t[0]]), space(drawn.position[t[1]]), space(drawn.position[t[2]])});
  ExactWarp exact(picture, space, 0.1 * error_px);
  for (std::size_t branch = 0; branch < picture.surface.branches().size(); ++branch)
    for (std::size_t f = 0; f < source.triangles.size(); ++f)
      if (const Corners& t = source.triangles[f]; !source.is_back[f])
        exact.cut(branch, {source.points[t[0]], source.points[t[1]], source.points[t[2]]});
  HausdorffReport report{0, error_px, exact.mesh().number_of_faces()};
  if (report.exact_triangles == 0) return report;
  if (warped.number_of_faces() == 0) throw Error(ErrorCode::input, "--hausdorff: the warped scene draws nothing");
  report.distance_px = CGAL::Polygon_mesh_processing::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(exact.mesh(), warped, error_px);
  return report;
}

} // namespace domewarp
