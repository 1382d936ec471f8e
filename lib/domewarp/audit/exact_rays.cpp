// SPDX-License-Identifier: GPL-3.0-or-later
#include "domewarp/audit/exact_rays.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <glm/geometric.hpp>

namespace domewarp {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_predicates_exact_constructions_kernel::FT;

struct Face {
  Kernel::Triangle_3 triangle;
  std::uint32_t object, index;
};

/// What CGAL's tree wants to know of a face.
struct FacePrimitive {
  using Id = const Face*;
  using Point = Kernel::Point_3;
  using Datum = Kernel::Triangle_3;
  using Point_reference = const Point&;
  using Datum_reference = const Datum&;

  FacePrimitive() = default;
  explicit FacePrimitive(std::vector<Face>::const_iterator face) : face_(&*face) {}
  Datum_reference datum() const { return face_->triangle; }
  Point_reference reference_point() const { return face_->triangle[0]; }
  Id id() const { return face_; }

private:
  const Face* face_ = nullptr;
};

using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, FacePrimitive>>;

/// Terms of a ray and a face, in exact numbers or in intervals: distance = volume / determinant, in lengths of the
/// direction; the weights sum up to the determinant, which is negative when the ray meets the front.
template <typename Number>
struct Terms {
  Number weights[3], determinant, volume;

  Terms(const Face& face, const Vec3& direction) {
    using Vector = std::array<Number, 3>;
    const auto dot = [](const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    const auto cross = [](const Vector& a, const Vector& b) {
      return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    Vector v[3];
    for (int i = 0; i < 3; ++i) v[i] = {Number(face.triangle[i].x()), Number(face.triangle[i].y()), Number(face.triangle[i].z())};
    const Vector d = {Number(direction.x), Number(direction.y), Number(direction.z)};
    const Vector c = cross(v[1], v[2]);
    weights[0] = dot(d, c);
    weights[1] = dot(d, cross(v[2], v[0]));
    weights[2] = dot(d, cross(v[0], v[1]));
    determinant = weights[0] + weights[1] + weights[2];
    volume = dot(v[0], c);
  }
};

using Interval = CGAL::Interval_nt<false>; ///< right only while the processor rounds up

/// A face on a ray, with an enclosure of its distance that mostly settles which of two is nearer.
struct Met {
  const Face* face;
  Interval distance;
};

std::vector<Met> enclose_distances(const std::vector<const Face*>& faces, const Vec3& direction) {
  const CGAL::Protect_FPU_rounding<true> round_up;
  std::vector<Met> met;
  for (const Face* face : faces) {
    const Terms<Interval> terms(*face, direction);
    met.push_back({face, terms.volume / terms.determinant});
  }
  return met;
}

/// False when the ray lies in the plane of the face or the face is at the eye.
bool is_ahead(const Met& met, const Vec3& direction) {
  if (met.distance.inf() > 0) return true;
  const Terms<Exact> exact(*met.face, direction);
  return exact.determinant != 0 && exact.volume / exact.determinant > 0;
}

bool is_nearer(const Met& a, const Met& b, const Vec3& direction) {
  if (a.distance.sup() < b.distance.inf()) return true;
  if (b.distance.sup() < a.distance.inf()) return false;
  const Terms<Exact> x(*a.face, direction), y(*b.face, direction);
  const CGAL::Comparison_result order = CGAL::compare(x.volume * y.determinant, y.volume * x.determinant);
  const bool same_side = (x.determinant > 0) == (y.determinant > 0);
  if (order != CGAL::EQUAL) return (order == CGAL::SMALLER) == same_side;
  return std::tie(a.face->object, a.face->index) < std::tie(b.face->object, b.face->index);
}

Vec3 vector(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

Crossing crossing_of(const Face& face, const Vec3& direction) {
  const Terms<double> terms(face, direction);
  Crossing crossing;
  crossing.distance = terms.volume / terms.determinant * glm::length(direction);
  crossing.object = face.object;
  crossing.triangle = face.index;
  for (int i = 0; i < 3; ++i) crossing.weights[i] = terms.weights[i] / terms.determinant;
  const Vec3 a = vector(face.triangle[0]);
  crossing.normal = glm::normalize(glm::cross(vector(face.triangle[1]) - a, vector(face.triangle[2]) - a));
  crossing.front = terms.determinant < 0;
  return crossing;
}

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Kernel::Point_3 point(const Vec3& p) { return {p.x, p.y, p.z}; }

/// Adds the triangles of one primitive, numbered from `number` on; those without area are left out.
void collect(const Primitive& primitive, const Mat4& world, const View& view, std::uint32_t object, std::uint32_t number,
             std::vector<Face>& faces) {
  for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3, ++number) {
    Vec3 v[3];
    for (std::size_t k = 0; k < 3; ++k) v[k] = to_eye(view, to_world(world, primitive.positions[primitive.indices[i + k]]));
    if (!is_finite(v[0]) || !is_finite(v[1]) || !is_finite(v[2])) continue;
    const Kernel::Triangle_3 triangle(point(v[0]), point(v[1]), point(v[2]));
    if (!triangle.is_degenerate()) faces.push_back({triangle, object, number});
  }
}

std::vector<Face> collect(const Scene& scene, const View& view) {
  std::vector<Face> faces;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    std::uint32_t number = 0;
    for (const Primitive& primitive : scene.meshes[std::size_t(scene.instances[i].mesh)].primitives) {
      if (primitive.topology != Topology::triangles) continue;
      collect(primitive, scene.instances[i].world, view, i + 1, number, faces);
      number += static_cast<std::uint32_t>(primitive.indices.size() / 3);
    }
  }
  return faces;
}

} // namespace

struct ExactRays::Impl {
  std::vector<Face> faces;
  Tree tree;
};

ExactRays::ExactRays(const Scene& scene, const View& view) : impl_(std::make_unique<Impl>()) {
  impl_->faces = collect(scene, view);
  impl_->tree.insert(impl_->faces.cbegin(), impl_->faces.cend());
  impl_->tree.build();
}

ExactRays::~ExactRays() = default;
ExactRays::ExactRays(ExactRays&&) noexcept = default;
ExactRays& ExactRays::operator=(ExactRays&&) noexcept = default;

std::vector<Crossing> ExactRays::crossings(const Vec3& direction) const {
  if (impl_->faces.empty()) return {};
  const Kernel::Ray_3 ray(Kernel::Point_3(0, 0, 0), Kernel::Vector_3(direction.x, direction.y, direction.z));
  std::vector<const Face*> met;
  impl_->tree.all_intersected_primitives(ray, std::back_inserter(met));
  std::vector<Met> ordered = enclose_distances(met, direction);
  std::erase_if(ordered, [&](const Met& m) { return !is_ahead(m, direction); });
  std::sort(ordered.begin(), ordered.end(), [&](const Met& a, const Met& b) { return is_nearer(a, b, direction); });
  std::vector<Crossing> crossings;
  for (const Met& m : ordered) crossings.push_back(crossing_of(*m.face, direction));
  return crossings;
}

} // namespace domewarp
