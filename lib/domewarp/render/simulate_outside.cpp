// SPDX-License-Identifier: Apache-2.0
//
// The display as a mesh in image units, eye space, traced like any other scene.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

#include "domewarp/render/ray_trace.h"
#include "domewarp/render/simulate.h"

namespace domewarp {

namespace {

constexpr int spokes = 720, rings = 192;
constexpr double shell_thickness = 0.01; ///< of the display, image units

/// Image radius at which the picture's rectangle ends along a spoke.
double rectangle_end(const Raster& raster, double angle) {
  const double x = std::abs(std::cos(angle)) / aspect(raster), y = std::abs(std::sin(angle));
  return 1 / std::max(x, y);
}

Vec3 on_display(const Surface& surface, double image_radius, double angle) {
  const Vec2 point = surface.meridian(image_radius).value_or(Vec2(0));
  return {point.x * std::cos(angle), point.x * std::sin(angle), -point.y};
}

void add_triangle(Primitive& primitive, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  primitive.indices.insert(primitive.indices.end(), {a, b, c});
}

/// Image radius at which the display is no longer drawn along a spoke: at the picture's end, at r_max, or where it has gone
/// far away, as lenses near 360 degrees do behind the eye.
double display_end(const Surface& surface, const Raster& raster, double angle) {
  const double farthest = std::max(8 * glm::length(on_display(surface, 0, angle)), 4.0);
  const auto is_near = [&](double radius) {
    const Vec3 p = on_display(surface, radius, angle);
    return glm::length(p) <= farthest && (radius == 0 || glm::length(p) > 0);
  };
  double low = 0, high = std::min(surface.r_max(), rectangle_end(raster, angle)) * (1 - 1e-9);
  if (is_near(high)) return high;
  for (int i = 0; i < 40; ++i) (is_near(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
  return low;
}

/// A grid of rings and spokes over the part of the picture that the display shows. Counter-clockwise from the eye.
Primitive make_shell(const Surface& surface, const Raster& raster, double outwards, bool facing_eye, int material) {
  Primitive primitive;
  primitive.material = material;
  Attribute uv{"TEXCOORD_0", 2, {}};
  std::vector<double> ends;
  for (int i = 0; i < spokes; ++i) ends.push_back(display_end(surface, raster, 2 * std::numbers::pi * i / spokes));
  for (int j = 0; j <= rings; ++j)
    for (int i = 0; i < spokes; ++i) {
      const double angle = 2 * std::numbers::pi * i / spokes;
      const double radius = ends[i] * j / rings;
      const Vec3 p = on_display(surface, radius, angle);
      const double length = glm::length(p);
      primitive.positions.push_back(Vec3f(length > 0 ? p * (1 + outwards / length) : p));
      uv.values.push_back(static_cast<float>(0.5 + 0.5 * radius * std::cos(angle) / aspect(raster)));
      uv.values.push_back(static_cast<float>(0.5 - 0.5 * radius * std::sin(angle)));
    }
  primitive.attributes.push_back(std::move(uv));
  for (std::uint32_t j = 0; j < rings; ++j)
    for (std::uint32_t i = 0; i < spokes; ++i) {
      const std::uint32_t next = (i + 1) % spokes, a = j * spokes + i, b = j * spokes + next;
      std::uint32_t quad[4] = {a, a + spokes, b + spokes, b};
      if (!facing_eye) std::swap(quad[1], quad[3]);
      add_triangle(primitive, quad[0], quad[1], quad[2]);
      add_triangle(primitive, quad[0], quad[2], quad[3]);
    }
  return primitive;
}

/// A thin three-sided bar from a to b.
void add_bar(Primitive& primitive, const Vec3& a, const Vec3& b, double radius) {
  const Vec3 along = b - a;
  if (!(glm::length(along) > 0)) return;
  const Vec3 aside = glm::normalize(glm::cross(along, std::abs(along.y) < 0.9 * glm::length(along) ? Vec3(0, 1, 0) : Vec3(1, 0, 0)));
  const Vec3 third = glm::normalize(glm::cross(along, aside));
  const auto first = static_cast<std::uint32_t>(primitive.positions.size());
  for (int i = 0; i < 3; ++i) {
    const double turn = 2 * std::numbers::pi * i / 3;
    const Vec3 offset = radius * (std::cos(turn) * aside + std::sin(turn) * third);
    primitive.positions.push_back(Vec3f(a + offset));
    primitive.positions.push_back(Vec3f(b + offset));
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t p = first + 2 * i, q = first + 2 * ((i + 1) % 3);
    add_triangle(primitive, p, q, q + 1);
    add_triangle(primitive, p, q + 1, p + 1);
  }
}

void add_path(Primitive& primitive, const std::vector<Vec3>& path, double radius) {
  for (std::size_t i = 1; i < path.size(); ++i) add_bar(primitive, path[i - 1], path[i], radius);
}

/// The frame of the eye's view, drawn on the display where it meets it.
void add_seen_part(Primitive& bars, const DisplayedPicture& displayed, const EyeCamera& camera, double thickness) {
  constexpr int steps = 64;
  const double w = camera.raster.width, h = camera.raster.height;
  const Vec2 corners[5] = {{0, 0}, {w, 0}, {w, h}, {0, h}, {0, 0}};
  for (int side = 0; side < 4; ++side) {
    std::vector<Vec3> path;
    for (int i = 0; i <= steps; ++i) {
      const Vec2 at = corners[side] + (corners[side + 1] - corners[side]) * (double(i) / steps);
      const auto point = displayed.point(direction_through(camera, at.x, at.y));
      if (point) path.push_back(*point * 0.99);
      if (!point) add_path(bars, path, thickness), path.clear();
    }
    add_path(bars, path, thickness);
    const Vec3 tip = 0.3 * glm::normalize(direction_through(camera, corners[side].x, corners[side].y));
    const Vec3 next = 0.3 * glm::normalize(direction_through(camera, corners[side + 1].x, corners[side + 1].y));
    add_bar(bars, Vec3(0), tip, 1.4 * thickness);
    add_bar(bars, tip, next, 1.4 * thickness);
  }
}

/// The projector's rays to the picture's corners, or where the display ends before them.
void add_beams(Primitive& bars, const Surface& surface, const Raster& raster, double thickness) {
  const double distance = *surface.options().projector, corner = std::atan2(1.0, aspect(raster));
  const Vec3 projector(0, 0, distance);
  for (const double angle : {corner, std::numbers::pi - corner, std::numbers::pi + corner, -corner}) {
    add_bar(bars, projector, on_display(surface, display_end(surface, raster, angle), angle), thickness);
  }
}

/// An eye far enough away along `from` that the camera sees all points, and nothing wasted around them.
Vec3 place_outside(const std::vector<Vec3f>& points, const Vec3& from, const EyeCamera& camera) {
  constexpr double margin = 1.06;
  const View local = turn_view(View{}, camera);
  const double half_height = std::tan(camera.fov_deg * std::numbers::pi / 360) / margin, half_width = half_height * aspect(camera.raster);
  Vec3 low(std::numeric_limits<double>::max()), high(-low);
  std::vector<Vec3> turned;
  for (const Vec3f& p : points) {
    turned.push_back({glm::dot(local.right, Vec3(p)), glm::dot(local.up, Vec3(p)), glm::dot(local.back, Vec3(p))});
    low = glm::min(low, turned.back()), high = glm::max(high, turned.back());
  }
  const Vec3 centre = 0.5 * (low + high);
  double back = high.z;
  for (const Vec3& p : turned)
    back = std::max({back, p.z + std::abs(p.x - centre.x) / half_width, p.z + std::abs(p.y - centre.y) / half_height});
  return centre.x * local.right + centre.y * local.up + back * from;
}

int add_material(Scene& scene, const Vec4& colour, bool unlit, int texture = -1) {
  Material material;
  material.base_color = colour;
  material.unlit = unlit;
  material.base_texture.texture = texture;
  scene.materials.push_back(std::move(material));
  return static_cast<int>(scene.materials.size() - 1);
}

/// The picture over the grey of a screen that no light falls on.
Pixels on_screen(const Pixels& picture) {
  Pixels opaque = picture;
  constexpr int unlit = 40;
  for (std::size_t i = 0; i < opaque.rgba.size(); i += 4) {
    const int alpha = opaque.rgba[i + 3];
    for (std::size_t k = i; k < i + 3; ++k)
      opaque.rgba[k] = static_cast<std::uint8_t>((opaque.rgba[k] * alpha + unlit * (255 - alpha)) / 255);
    opaque.rgba[i + 3] = 255;
  }
  return opaque;
}

} // namespace

Pixels outside_view(const Pixels& picture, const Surface& surface, const EyeCamera& camera, const Raster& raster) {
  const Raster shape{picture.width, picture.height};
  Scene scene;
  const Pixels shown = on_screen(picture);
  scene.images.push_back({"picture", "image/png", "", encode_png(shown.width, shown.height, 4, shown.rgba)});
  scene.samplers.push_back({33071, 33071, 9729, 9729});
  scene.textures.push_back({0, 0, ""});
  const int front = add_material(scene, Vec4(1), true, 0), shell = add_material(scene, Vec4(0.35, 0.37, 0.4, 1), false);
  const int red = add_material(scene, Vec4(0.8, 0.02, 0.02, 1), true), yellow = add_material(scene, Vec4(1, 0.75, 0.1, 1), true);
  Mesh mesh;
  mesh.primitives.push_back(make_shell(surface, shape, 0, true, front));
  mesh.primitives.push_back(make_shell(surface, shape, shell_thickness, false, shell));
  const std::vector<Vec3f> extent = mesh.primitives.front().positions;
  double thickness = 0;
  for (const Vec3f& p : extent) thickness = std::max(thickness, 0.004 * double(glm::length(p)));
  Primitive seen, beams;
  seen.material = red;
  beams.material = yellow;
  add_seen_part(seen, DisplayedPicture(surface, shape), camera, thickness);
  mesh.primitives.push_back(std::move(seen));
  if (surface.options().projector) {
    add_beams(beams, surface, shape, 0.7 * thickness);
    mesh.primitives.push_back(std::move(beams));
  }
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({"display", 0, Mat4(1)});

  EyeCamera outside;
  outside.raster = raster;
  outside.fov_deg = 36;
  const Vec3 from = glm::normalize(Vec3(0.8, 0.5, 1));
  outside.look = -from;
  View view;
  view.eye = place_outside(extent, from, outside);
  RayTraceOptions options;
  options.samples = 16;
  options.background = {24, 26, 30, 255};
  options.layers = Layers::colours;
  return colours(ray_trace(scene, turn_view(view, outside), flat_surface(outside), raster, options));
}

} // namespace domewarp
