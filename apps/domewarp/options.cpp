// SPDX-License-Identifier: Apache-2.0
#include "options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>

#include <CLI/CLI.hpp>

#include "domewarp/core/errors.h"
#include "domewarp/profile/measured.h"

namespace domewarp {

double parse_number(const std::string& option, const std::string& text) {
  double value = 0;
  const char* first = text.data() + (!text.empty() && text[0] == '+');
  const auto [end, status] = std::from_chars(first, text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw Error(ErrorCode::usage, option + ": needs a number, got '" + text + "'");
  return value;
}

std::size_t parse_count(const std::string& option, const std::string& text) {
  std::size_t value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size())
    throw Error(ErrorCode::usage, option + ": needs a whole number, got '" + text + "'");
  return value;
}

double parse_positive(const std::string& option, const std::string& text) {
  const double value = parse_number(option, text);
  if (!(value > 0)) throw Error(ErrorCode::usage, option + ": must be greater than 0, got " + text);
  return value;
}

std::uint64_t parse_memory(const std::string& option, const std::string& text) {
  const std::size_t mib = parse_count(option, text);
  if (mib < 1 || mib > (std::size_t(1) << 40)) throw Error(ErrorCode::usage, option + ": must be at least 1 MiB, got " + text);
  return std::uint64_t(mib) << 20;
}

Vec3 parse_vector(const std::string& option, const std::string& text) {
  Vec3 v;
  std::size_t begin = 0;
  for (int i = 0; i < 3; ++i) {
    const std::size_t comma = i < 2 ? text.find(',', begin) : text.size();
    if (comma == std::string::npos) throw Error(ErrorCode::usage, option + ": needs three numbers X,Y,Z, got '" + text + "'");
    const std::size_t first = std::min(text.find_first_not_of(' ', begin), comma);
    v[i] = parse_number(option, text.substr(first, comma - first));
    begin = comma + 1;
  }
  return v;
}

namespace {

Raster parse_size(const std::string& option, const std::string& text) {
  const std::size_t x = text.find('x');
  if (x == std::string::npos) throw Error(ErrorCode::usage, option + ": needs WIDTHxHEIGHT, got '" + text + "'");
  const std::size_t width = parse_count(option, text.substr(0, x)), height = parse_count(option, text.substr(x + 1));
  constexpr std::size_t largest = 65536;
  if (width < 1 || height < 1 || width > largest || height > largest)
    throw Error(ErrorCode::usage, option + ": each side must be from 1 to 65536 pixels, got '" + text + "'");
  return {static_cast<int>(width), static_cast<int>(height)};
}

/// An option whose text is turned into a value while the line is parsed.
CLI::Option* add(CLI::App& app, const char* name, const std::string& help, const char* type,
                 const std::function<void(const std::string&)>& take) {
  return app.add_option_function<std::string>(name, take, help)->type_name(type);
}

template <typename Value>
CLI::Option* add_choice(CLI::App& app, const char* name, const std::string& help, std::map<std::string, Value> choices,
                        std::function<void(Value)> take) {
  std::string names;
  for (const auto& [key, value] : choices) names += (names.empty() ? "" : "|") + key;
  const std::string option = name;
  return add(app, name, help, "", [=](const std::string& text) {
           const auto found = choices.find(text);
           if (found == choices.end()) throw Error(ErrorCode::usage, option + ": must be one of " + names + ", got '" + text + "'");
           take(found->second);
         })->type_name(names);
}

} // namespace

std::vector<const CLI::Option*> all_options(const CLI::App& app) {
  std::vector<const CLI::Option*> options = app.get_options();
  for (const CLI::App* group : app.get_subcommands([](const CLI::App* sub) { return sub->get_name().empty(); })) {
    const std::vector<const CLI::Option*> more = all_options(*group);
    options.insert(options.end(), more.begin(), more.end());
  }
  return options;
}

void add_threads_option(CLI::App& app, int& threads) {
  add(app, "--threads", "Threads to use (default: all)", "N",
      [&threads](const std::string& text) { threads = static_cast<int>(std::min<std::size_t>(parse_count("--threads", text), 1024)); });
}

void add_read_options(CLI::App& app, ReadOptions& read) {
  app.add_option("--scene", read.scene, "Scene of the file to read (default: the file's)")->type_name("NAME|INDEX");
  add_pose_options(app, read);
}

void add_pose_options(CLI::App& app, ReadOptions& read) {
  add(app, "--animation", "Animation to pose the scene with (default: the rest pose)", "NAME|INDEX", [&read](const std::string& text) {
    if (text.empty()) throw Error(ErrorCode::usage, "--animation: is empty");
    read.animation = text;
  });
  add(app, "--time", "Time of the animation, seconds (default 0)", "T",
      [&read](const std::string& text) { read.time = parse_number("--time", text); });
  app.add_flag("--allow-external", read.allow_external, "Follow URIs that leave the scene's folder");
}

void add_view_options(CLI::App& app, ViewOptions& view) {
  auto* group = app.add_option_group("View");
  const auto add_vector = [&](const char* name, const char* help, std::optional<Vec3>& out) {
    add(*group, name, help, "X,Y,Z", [name, &out](const std::string& text) { out = parse_vector(name, text); });
  };
  add_vector("--eye", "Where the viewer is (default: the camera's place)", view.eye);
  add_vector("--target", "A point on the principal axis", view.target);
  add_vector("--forward", "Direction of the principal axis", view.forward);
  add_vector("--up", "Up direction (default: +y)", view.up);
  add(*group, "--camera", "A camera of the scene (default: its first; without any, an eye in front of the scene)", "NAME|INDEX",
      [&view](const std::string& text) {
        if (text.empty()) throw Error(ErrorCode::usage, "--camera: is empty");
        view.camera = text;
      });
}

void add_surface_options(CLI::App& app, SurfaceOptions& surface) {
  auto* group = app.add_option_group("Surface");
  add(*group, "--curve", "Profile curve z = f(r) of the display, for example 1-r^2, in image units (1: half the picture's height); + - * / ^, pi, e, sqrt exp ln log log10 sin cos tan asin acos atan sinh cosh tanh abs min max pow", "EXPR", [&surface](const std::string& text) {
    if (text.empty()) throw Error(ErrorCode::usage, "--curve: is empty");
    surface.curve = text;
  });
  add_choice<Lens>(*group, "--lens", "Lens preset; its field of view ends at image radius 1",
                   {{"equidistant", Lens::equidistant}, {"equisolid", Lens::equisolid}, {"stereographic", Lens::stereographic}, {"orthographic", Lens::orthographic}},
                   [&surface](Lens lens) { surface.lens = lens; });
  add(*group, "--fov", "Full field of view of the lens, degrees (default 180)", "DEG",
      [&surface](const std::string& text) { surface.fov_deg = parse_positive("--fov", text); });
  add(*group, "--profile", "Measured profile of the display: rows of 'r z', in image units unless --profile-unit says otherwise", "FILE", [&surface](const std::string& text) {
    surface.profile = read_profile(text);
    for (Vec2& row : surface.profile) row /= surface.profile_unit;
    surface.profile_name = text;
  });
  add(*group, "--profile-unit", "Length in the profile's file that is one image unit, for example the dome's radius (default 1)", "LENGTH",
      [&surface](const std::string& text) {
        const double unit = parse_positive("--profile-unit", text);
        for (Vec2& row : surface.profile) row *= surface.profile_unit / unit; // was read before
        surface.profile_unit = unit;
      });
  add(*group, "--rmax", "Largest image radius to show (default: the picture's corners)", "R",
      [&surface](const std::string& text) { surface.rmax = parse_positive("--rmax", text); });
  add(*group, "--projector", "Distance of the projector behind the eye, image units", "D",
      [&surface](const std::string& text) { surface.projector = parse_positive("--projector", text); });
  add_choice<BranchChoice>(*group, "--branch", "Crossings of a multi-valued curve that are drawn (default all)",
                           {{"all", BranchChoice::all}, {"first", BranchChoice::first}},
                           [&surface](BranchChoice choice) { surface.branches = choice; });
}

void require_surface(const SurfaceOptions& surface) {
  const int given = !surface.curve.empty() + surface.lens.has_value() + !surface.profile.empty();
  if (given != 1) throw Error(ErrorCode::usage, "exactly one of --curve, --lens and --profile is needed, got " + std::to_string(given));
}

void add_raster_options(CLI::App& app, Raster& raster) {
  const std::string size = std::to_string(raster.width) + "x" + std::to_string(raster.height);
  add(app, "--size", "Size of the picture (default " + size + ")", "WxH", [&raster](const std::string& text) { raster = parse_size("--size", text); });
}

void add_method_option(CLI::App& app, Method& method) {
  add_choice<Method>(app, "--method", "How points are mapped; auto: tables from about 400 points on (default auto)",
                     {{"auto", Method::automatic}, {"direct", Method::direct}, {"lut", Method::table}}, [&method](Method m) { method = m; });
}

/// May be given several times.
void add_no_skip_option(CLI::App& app, SkipOptions& skip) {
  std::map<std::string, bool SkipOptions::*> names;
  for (const SkipName& skip_name : skip_names) names[skip_name.name] = skip_name.member;
  add_choice<bool SkipOptions::*>(app, "--no-skip", "Do work that the picture does not need, to measure what skipping it saves; may be repeated",
                                  names, [&skip](bool SkipOptions::*member) { skip.*member = false; })
      ->trigger_on_parse();
}

constexpr double least_tolerance_px = 1e-4;

void add_quality_options(CLI::App& app, RefineOptions& refine) {
  auto* group = app.add_option_group("Quality");
  add(*group, "--tolerance", "Largest displacement of any drawn point, pixels (default 0.5)", "PX",
      [&refine](const std::string& text) {
        refine.tolerance_px = parse_positive("--tolerance", text);
        if (refine.tolerance_px < least_tolerance_px)
          throw Error(ErrorCode::usage, "--tolerance: must be at least 0.0001, which the single precision of the file resolves in 4096 rows, got " + text);
      });
  add(*group, "--texture-tolerance", "The same inside faces, where only what they show can slide; depth and outlines hold (default: --tolerance)", "PX",
      [&refine](const std::string& text) { refine.texture_tolerance_px = parse_positive("--texture-tolerance", text); });
  add(*group, "--plain-tolerance", "The same inside faces of one colour and one normal, where nobody sees it (default: --texture-tolerance)", "PX",
      [&refine](const std::string& text) { refine.plain_tolerance_px = parse_positive("--plain-tolerance", text); });
  add(*group, "--depth-tolerance", "Largest relative error of the depth, of edges and faces (default 0.0025)", "REL",
      [&refine](const std::string& text) { refine.depth_tolerance = parse_positive("--depth-tolerance", text); });
  add(*group, "--near", "Nothing nearer to the eye is drawn (default: 1e-5 of the scene's extent)", "D",
      [&refine](const std::string& text) { refine.near = parse_positive("--near", text); });
  add(*group, "--max-triangles", "Stop refinement there, say so and exit with 3 (default 50000000)", "N",
      [&refine](const std::string& text) { refine.max_triangles = parse_count("--max-triangles", text); });
  add_choice<Subdivision>(*group, "--subdivide", "adaptive: as the tolerance needs; isotropic: the thesis' recursion; none: only clip (default adaptive)",
                          {{"adaptive", Subdivision::adaptive}, {"isotropic", Subdivision::isotropic}, {"none", Subdivision::none}},
                          [&refine](Subdivision subdivision) { refine.subdivision = subdivision; });
  add(*group, "--threshold", "Longest edge that --subdivide isotropic leaves, image units (default 0.1)", "T",
      [&refine](const std::string& text) { refine.isotropic.threshold = parse_positive("--threshold", text); });
  add(*group, "--max-lod", "How often --subdivide isotropic divides a triangle at most, 0 to 12 (default 9)", "N",
      [&refine](const std::string& text) { refine.isotropic.max_lod = static_cast<int>(std::min<std::size_t>(parse_count("--max-lod", text), 1000)); });
  add(*group, "--weld", "Join positions this near, scene units (default: only those equal to the bit)", "D",
      [&refine](const std::string& text) { refine.weld = parse_positive("--weld", text); });
  add_no_skip_option(*group, refine.skip);
}

constexpr double default_extension_deg = 10;

void add_output_options(CLI::App& app, ConvertOptions& options) {
  auto* group = app.add_option_group("Output");
  add_choice<Projection>(*group, "--projection", "Camera of the written file (default perspective)",
                         {{"perspective", Projection::perspective}, {"orthographic", Projection::orthographic}},
                         [&options](Projection projection) { options.refine.projection = projection; });
  add_choice<Shading>(*group, "--shading", "keep: normals and directional lights in eye space; unlit: colours as they are; bake: light in the colours (default keep)",
                      {{"keep", Shading::keep}, {"unlit", Shading::unlit}, {"bake", Shading::bake}},
                      [&options](Shading shading) { options.shading = shading; });
  group->add_flag_callback("--unlit", [&options] { options.shading = Shading::unlit; }, "The same as --shading unlit: mark every material KHR_materials_unlit");
  add_choice<bool>(*group, "--boundary", "clip: end at r_max; tangent: go on beyond it along the surface's tangent, for programs that clip themselves (default clip)",
                   {{"clip", false}, {"tangent", true}}, [&options](bool is_tangent) {
                     double& extension = options.surface.extension_deg;
                     extension = is_tangent ? (extension > 0 ? extension : default_extension_deg) : 0;
                   });
  add(*group, "--extension", "How far --boundary tangent, which this implies, goes on, degrees (default 10); less where blind directions are near", "DEG",
      [&options](const std::string& text) { options.surface.extension_deg = parse_positive("--extension", text); });
  group->add_flag("--cull-hidden", options.cull_hidden,
                  "Leave out triangles that no ray at twice the picture's density reaches within a pixel (opens edges: inspect --strict will say so)");
  group->add_flag("--source-attributes", options.refine.source_attributes, "Add _SOURCE_POSITION, where each vertex came from (eye space)");
}

void add_bake_options(CLI::App& app, BakeOptions& bake) {
  auto* group = app.add_option_group("Light (--shading bake)");
  group->add_flag("--shadows", bake.shadows, "Let opaque surfaces keep the scene's lights away");
  add(*group, "--light-tolerance", "What the light of a white surface may be off along an edge, steps of 1/255 of sRGB (default 4); judged at three places of the edge, not certified", "STEPS",
      [&bake](const std::string& text) { bake.tolerance = parse_positive("--light-tolerance", text); });
  add(*group, "--exposure", "Brighten the scene's lights by so many stops (default 0)", "STOPS",
      [&bake](const std::string& text) { bake.exposure = parse_number("--exposure", text); });
}

void add_job_options(CLI::App& app, JobOptions& job) {
  add_view_options(app, job.convert.view);
  add_surface_options(app, job.convert.surface);
  add_raster_options(app, job.convert.raster);
  add_method_option(app, job.convert.method);
  add_quality_options(app, job.convert.refine);
  add_output_options(app, job.convert);
  add_bake_options(app, job.convert.bake);
  app.add_flag("--draco", job.write.draco, "Compress with KHR_draco_mesh_compression, one grid for the file");
  app.add_flag("--quantize", job.write.quantize, "Store integers (KHR_mesh_quantization), one grid for the file");
  app.add_flag("--meshopt", job.write.meshopt, "Compress with EXT_meshopt_compression, without loss; together with --quantize smaller yet");
  add_read_options(app, job.read);
}

} // namespace domewarp
