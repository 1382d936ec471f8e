// SPDX-License-Identifier: Apache-2.0
// Based on: vertex lighting with the mesh refined where its interpolation errs (Cohen and Wallace 1993, chapter 6, for
// radiosity), here for direct light and by sRGB steps.
#include "domewarp/convert/bake.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <sstream>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "domewarp/render/parts.h"
#include "domewarp/render/ray_geometry.h"
#include "domewarp/render/ray_shade.h"
#include "domewarp/render/shading.h"

namespace domewarp {

namespace {

/// Longer edges than this share of the picture's height (2 image units) are split unseen, so that no larger patch of
/// light falls between the samples.
constexpr double longest_edge = 2.0 / 64;

/// How far from a triangle a point may be that lies on it, relative to its distance from the eye.
constexpr double on_triangle = 1e-7;

/// Light is looked up this far inside the triangle, relative to the distance from the eye: a vertex where two surfaces
/// meet, one of which hides the light from the other, belongs to both. Less than a pixel.
constexpr double inset = 1e-4;

/// Largest difference on a display, steps of 1/255.
double visible_difference(const Vec3& x, const Vec3& y) {
  double largest = 0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(encode_srgb(x[c]) - encode_srgb(y[c])));
  return 255 * largest;
}

Vec3 moved_inside(const Vec3& point, const Vec3& centre) {
  const double distance = glm::length(centre - point);
  if (!(distance > 0)) return point;
  return point + (centre - point) * std::min(0.25, inset * glm::length(point) / distance);
}

bool glows(const Look& look) { return !look.unlit && look.emissive != Vec3(0); }

/// Colours can hold a glow when no texture multiplies them.
bool can_hold_glow(const Look& look) { return look.base.pixels == nullptr && look.glow.pixels == nullptr; }

/// Takes the glow out of a material, whose colour becomes white where the vertices hold all of it.
void take_glow(Material& material, bool is_in_vertices) {
  material.emissive = Vec3(0);
  material.emissive_texture = {};
  if (is_in_vertices) material.base_color = Vec4(1, 1, 1, material.base_color.a);
  if (material.json.empty()) return;
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(material.json);
  json.erase("emissiveFactor");
  json.erase("emissiveTexture");
  if (json.contains("extensions")) json["extensions"].erase("KHR_materials_emissive_strength");
  if (is_in_vertices) json["pbrMetallicRoughness"]["baseColorFactor"] = {1.0, 1.0, 1.0, material.base_color.a};
  material.json = json.dump();
}

} // namespace

struct LightBaker::Impl {
  const Scene& scene;
  BakeOptions options;
  View view;
  Parts parts;
  RayGeometry geometry;
  std::vector<PlacedLight> lights;
  RayWorld world;
  double weld = 0;
  mutable std::atomic<std::size_t> vertices{0}, clipped{0};
  mutable std::atomic<double> brightest{0};

  Impl(const Scene& source, const View& from, const BakeOptions& given)
      : scene(source), options(given), view(from), parts(prepare_parts(source)), geometry(parts, view, ""),
        lights(place_lights(source, world_to_eye(from))),
        world{view, geometry, {false, lights.empty() ? nullptr : &lights, std::exp2(given.exposure)}, given.shadows, 0} {}

  /// Linear colour without what the material multiplies it with.
  Vec3 lit(const Look& look, SurfacePoint point, const Vec3& centre) const {
    if (look.unlit) return Vec3(point.color);
    point.position = moved_inside(point.position, centre);
    unsigned rays = 0;
    const Vec3 colour = light_at(world, look, point, rays) * Vec3(point.color);
    return glows(look) && can_hold_glow(look) ? colour * Vec3(look.base_color) + look.emissive : colour;
  }

  /// Whether interpolation between the ends of an edge of a triangle errs by more than the tolerance.
  bool varies_on(RayHit hit, const std::array<double, 3>& a, const std::array<double, 3>& b) const {
    const Vec3 centre = (geometry.corner(hit, 0) + geometry.corner(hit, 1) + geometry.corner(hit, 2)) / 3.0;
    const auto lit_at = [&](double t) {
      for (std::size_t k = 0; k < 3; ++k) hit.weights[k] = (1 - t) * a[k] + t * b[k];
      return lit(*hit.part->look, surface_point(world, hit), centre);
    };
    const Vec3 from = lit_at(0), to = lit_at(1);
    for (const double t : {0.5, 0.25, 0.75})
      if (visible_difference(lit_at(t), glm::mix(from, to, t)) > options.tolerance) return true;
    return false;
  }

  bool varies(const MappedPoint& a, const MappedPoint& b) const {
    if (glm::length(b.mapped.image - a.mapped.image) > longest_edge) return true;
    const double tolerance = on_triangle * std::max(glm::length(a.eye), glm::length(b.eye)) + weld;
    thread_local std::vector<RayHit> hits;
    geometry.triangles_at(0.5 * (a.eye + b.eye), tolerance, hits);
    return std::any_of(hits.begin(), hits.end(), [&](const RayHit& hit) {
      if (hit.part->look->unlit) return false;
      const auto from = geometry.weights_at(hit, a.eye, tolerance), to = geometry.weights_at(hit, b.eye, tolerance);
      return from && to && varies_on(hit, *from, *to);
    });
  }

  Vec4 colour(const VertexToColour& vertex) const {
    const Primitive& primitive = scene.meshes[scene.instances[vertex.instance].mesh].primitives[vertex.primitive];
    SurfacePoint point;
    point.position = vertex.eye;
    point.normal = vertex.normal;
    point.face = vertex.face_normal;
    point.color = vertex.colour;
    const Vec3 colour = lit(parts.looks[primitive.material + 1], point, vertex.face_centre);
    const double most = std::max({colour.x, colour.y, colour.z});
    ++vertices;
    if (most > 1 + 1e-6) ++clipped;
    for (double seen = brightest; most > seen && !brightest.compare_exchange_weak(seen, most);) {}
    return Vec4(glm::clamp(colour, Vec3(0), Vec3(1)), vertex.colour.a);
  }
};

LightBaker::LightBaker(const Scene& scene, const View& view, const BakeOptions& options)
    : impl_(std::make_unique<Impl>(scene, view, options)) {}

LightBaker::~LightBaker() = default;

void LightBaker::attach(RefineOptions& options) {
  impl_->weld = options.weld;
  options.criterion = [this](const MappedPoint& a, const MappedPoint& b) { return impl_->varies(a, b); };
  options.vertex_colour = [this](const VertexToColour& vertex) { return impl_->colour(vertex); };
}

BakeReport LightBaker::finish(Scene& warped) const {
  BakeReport report{impl_->lights.size(), impl_->vertices, impl_->clipped, impl_->brightest, 0};
  for (std::size_t i = 0; i < warped.materials.size(); ++i) {
    Material& material = warped.materials[i];
    const Look& look = impl_->parts.looks[i + 1];
    if (glows(look)) {
      take_glow(material, can_hold_glow(look));
      report.glowing_materials += !can_hold_glow(look);
    }
    material.unlit = true;
  }
  for (Mesh& mesh : warped.meshes)
    for (Primitive& primitive : mesh.primitives)
      std::erase_if(primitive.attributes, [](const Attribute& attribute) { return attribute.name == "NORMAL" || attribute.name == "TANGENT"; });
  return report;
}

std::vector<std::string> bake_warnings(const BakeReport& report) {
  std::vector<std::string> warnings;
  std::ostringstream text;
  text.precision(2);
  if (report.clipped_vertices > 0) {
    text << "the light is brighter than white at " << 100.0 * static_cast<double>(report.clipped_vertices) / static_cast<double>(report.vertices)
         << " % of the vertices and clipped there; --exposure lower by " << std::log2(report.brightest) << " would keep all of it";
    warnings.push_back(text.str());
  }
  if (report.glowing_materials > 0)
    warnings.push_back("left out the glow of " + std::to_string(report.glowing_materials) + " material(s), which a texture shapes: colours cannot hold it");
  return warnings;
}

} // namespace domewarp
