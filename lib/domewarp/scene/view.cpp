// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/view.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/scene/raster.h"

namespace domewarp {

double screen_radius(const Raster& raster) { return std::hypot(aspect(raster), 1.0); }

Vec3 to_world(const Mat4& world, const Vec3f& position) { return Vec3(world * Vec4(Vec3(position), 1.0)); }

Vec3 to_eye(const View& view, const Vec3& world) {
  const Vec3 d = world - view.eye;
  return {glm::dot(view.right, d), glm::dot(view.up, d), glm::dot(view.back, d)};
}

Mat4 world_to_eye(const View& view) {
  Mat4 matrix(1);
  for (int i = 0; i < 3; ++i) {
    matrix[i][0] = view.right[i];
    matrix[i][1] = view.up[i];
    matrix[i][2] = view.back[i];
  }
  matrix[3] = Vec4(-glm::dot(view.right, view.eye), -glm::dot(view.up, view.eye), -glm::dot(view.back, view.eye), 1);
  return matrix;
}

namespace {

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Vec3 unit(const Vec3& v, const char* option) {
  const double scale = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!is_finite(v) || !(scale > 0)) throw Error(ErrorCode::usage, std::string(option) + ": needs a direction that is finite and not zero");
  return glm::normalize(v / scale);
}

View look_along(const Vec3& eye, const Vec3& forward, const Vec3& up) {
  const Vec3 back = -forward;
  const Vec3 right = glm::cross(up, back);
  if (glm::length(right) < 1e-9) throw Error(ErrorCode::usage, "--up: is parallel to the view direction");
  View view;
  view.eye = eye;
  view.back = back;
  view.right = glm::normalize(right);
  view.up = glm::cross(view.back, view.right);
  return view;
}

/// A sensible up vector for a view direction when none is given: +y, or -z / +z for straight up and down.
Vec3 default_up(const Vec3& forward) {
  if (std::abs(forward.y) < 0.999999) return {0, 1, 0};
  return {0, 0, forward.y > 0 ? 1.0 : -1.0};
}

const Camera& find_camera(const Scene& scene, const std::string& name) {
  for (const Camera& camera : scene.cameras)
    if (camera.name == name) return camera;
  std::size_t index = 0;
  const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), index);
  if (status == std::errc() && end == name.data() + name.size() && index < scene.cameras.size()) return scene.cameras[index];
  throw Error(ErrorCode::usage, "--camera " + name + ": the scene has " + std::to_string(scene.cameras.size()) +
                                    " camera(s) and none of that name or index");
}

View view_of_camera(const Camera& camera) {
  const Vec3 forward = -Vec3(camera.world[2]);
  return look_along(Vec3(camera.world[3]), unit(forward, "--camera"), unit(Vec3(camera.world[1]), "--camera"));
}

/// Far enough on the +z side that the bounding sphere fills 90 degrees: distance = radius * sqrt(2).
View view_in_front(const Scene& scene) {
  const std::optional<Box> box = bounding_box(scene);
  if (!box) return View{};
  const Vec3 centre = 0.5 * (box->low + box->high);
  const double radius = std::max(0.5 * glm::length(box->high - box->low), 1e-6);
  View view;
  view.eye = centre + Vec3(0, 0, radius * std::sqrt(2.0));
  return view;
}

} // namespace

View resolve_view(const Scene& scene, const ViewOptions& options) {
  if (options.target && options.forward) throw Error(ErrorCode::usage, "--target and --forward exclude each other");
  if (options.eye && !is_finite(*options.eye)) throw Error(ErrorCode::usage, "--eye: needs three finite numbers");
  if (options.target && !is_finite(*options.target)) throw Error(ErrorCode::usage, "--target: needs three finite numbers");
  View base = !options.camera.empty()      ? view_of_camera(find_camera(scene, options.camera))
              : !scene.cameras.empty() && !options.eye ? view_of_camera(scene.cameras.front())
              : options.eye                ? View{}
                                           : view_in_front(scene);
  if (options.eye) base.eye = *options.eye;
  if (!options.target && !options.forward && !options.up) return base;
  Vec3 forward = -base.back;
  if (options.forward) forward = unit(*options.forward, "--forward");
  if (options.target) {
    if (*options.target == base.eye) throw Error(ErrorCode::usage, "--target: is where the eye is");
    forward = unit(*options.target - base.eye, "--target");
  }
  const Vec3 up = options.up ? unit(*options.up, "--up") : default_up(forward);
  return look_along(base.eye, forward, up);
}

} // namespace domewarp
