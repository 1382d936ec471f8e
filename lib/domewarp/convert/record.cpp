// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/record.h"

#include <array>
#include <limits>

#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"

namespace domewarp {

namespace {

using Json = nlohmann::ordered_json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN(); ///< null in JSON

constexpr std::array<const char*, 4> lens_names = {"equidistant", "equisolid", "stereographic", "orthographic"};

Json vector(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

Vec3 vector(const Json& json) { return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()}; }

Json surface_json(const SurfaceOptions& surface) {
  Json json;
  if (!surface.curve.empty()) json["curve"] = surface.curve;
  if (surface.lens) {
    json["lens"] = lens_names[static_cast<std::size_t>(*surface.lens)];
    json["fov_deg"] = surface.fov_deg;
  }
  if (!surface.profile.empty()) {
    json["profile_name"] = surface.profile_name;
    for (const Vec2& row : surface.profile) json["profile"].push_back({row.x, row.y});
  }
  if (surface.rmax) json["rmax"] = *surface.rmax;
  if (surface.extension_deg != 0) json["extension_deg"] = surface.extension_deg;
  if (surface.projector) json["projector"] = *surface.projector;
  json["branch"] = surface.branches == BranchChoice::all ? "all" : "first";
  return json;
}

SurfaceOptions parse_surface(const Json& json) {
  SurfaceOptions surface;
  surface.curve = json.value("curve", "");
  if (json.contains("lens"))
    for (std::size_t i = 0; i < lens_names.size(); ++i)
      if (json["lens"] == lens_names[i]) surface.lens = static_cast<Lens>(i);
  surface.fov_deg = json.value("fov_deg", surface.fov_deg);
  if (json.contains("profile"))
    for (const Json& row : json["profile"]) surface.profile.push_back({row.at(0).get<double>(), row.at(1).get<double>()});
  surface.profile_name = json.value("profile_name", "");
  if (json.contains("rmax")) surface.rmax = json["rmax"].get<double>();
  surface.extension_deg = json.value("extension_deg", 0.0);
  if (json.contains("projector")) surface.projector = json["projector"].get<double>();
  if (json.value("branch", "all") == "first") surface.branches = BranchChoice::first;
  return surface;
}

} // namespace

Record make_record(const ConvertOptions& options, const ConvertReport& report) {
  Record record;
  record.version = DOMEWARP_VERSION;
  record.view = report.view;
  record.surface = options.surface;
  record.raster = options.raster;
  record.projection = options.refine.projection;
  record.tolerance_px = options.refine.tolerance_px;
  record.near = report.refine.near;
  record.unlit = options.shading == Shading::unlit;
  record.baked = options.shading == Shading::bake;
  record.shadows = record.baked && options.bake.shadows;
  record.exposure = record.baked ? options.bake.exposure : 0;
  record.error_px = report.refine.error_px_max;
  record.depth_error = report.refine.depth_error_max;
  record.triangles_in = report.refine.triangles_in;
  record.triangles_out = report.refine.triangles_out;
  record.vertices = report.refine.vertices;
  return record;
}

std::string to_json(const SurfaceOptions& surface) { return surface_json(surface).dump(); }

std::string to_json(const Record& record) {
  Json json;
  json["version"] = record.version;
  json["surface"] = surface_json(record.surface);
  json["view"] = {{"eye", vector(record.view.eye)},
                  {"right", vector(record.view.right)},
                  {"up", vector(record.view.up)},
                  {"back", vector(record.view.back)}};
  json["raster"] = {{"width", record.raster.width}, {"height", record.raster.height}};
  json["projection"] = record.projection == Projection::perspective ? "perspective" : "orthographic";
  json["tolerance_px"] = record.tolerance_px;
  json["near"] = record.near;
  json["unlit"] = record.unlit;
  if (record.baked) json["baked"] = {{"shadows", record.shadows}, {"exposure", record.exposure}};
  json["error_px"] = record.error_px;
  json["depth_error"] = record.depth_error;
  json["triangles"] = {{"input", record.triangles_in}, {"output", record.triangles_out}};
  json["vertices"] = record.vertices;
  return json.dump();
}

Record parse_record(const std::string& text, const std::string& name) {
  if (text.empty()) throw Error(ErrorCode::input, name + ": has no asset.extras.domewarp: it was not written by domewarp convert");
  try {
    const Json json = Json::parse(text);
    Record record;
    record.version = json.value("version", "");
    record.surface = parse_surface(json.at("surface"));
    const Json& view = json.at("view");
    record.view = {vector(view.at("eye")), vector(view.at("right")), vector(view.at("up")), vector(view.at("back"))};
    record.raster = {json.at("raster").at("width").get<int>(), json.at("raster").at("height").get<int>()};
    record.projection = json.at("projection") == "orthographic" ? Projection::orthographic : Projection::perspective;
    record.tolerance_px = json.at("tolerance_px").get<double>();
    record.near = json.value("near", 0.0);
    record.unlit = json.value("unlit", false);
    record.baked = json.contains("baked");
    if (record.baked) {
      record.shadows = json["baked"].value("shadows", false);
      record.exposure = json["baked"].value("exposure", 0.0);
    }
    record.error_px = json.contains("error_px") && json["error_px"].is_number() ? json["error_px"].get<double>() : nan;
    const bool bounded = json.contains("depth_error") && json["depth_error"].is_number();
    record.depth_error = bounded ? json["depth_error"].get<double>() : RefineOptions{}.depth_tolerance;
    if (json.contains("triangles")) record.triangles_in = json["triangles"].value("input", std::size_t{0});
    return record;
  } catch (const Json::exception& error) {
    throw Error(ErrorCode::input, name + ": asset.extras.domewarp cannot be understood: " + error.what());
  }
}

} // namespace domewarp
