// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/simulate.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/core/parallel.h"
#include "domewarp/render/edges.h"
#include "domewarp/render/ray_trace.h"
#include "domewarp/render/sampling.h"
#include "render_scenes.h"

namespace domewarp {
namespace {

/// A picture of random colours, opaque.
Pixels make_noise(int width, int height) {
  Pixels pixels{width, height, {}};
  for (int i = 0; i < width * height; ++i)
    for (int k = 0; k < 4; ++k) pixels.rgba.push_back(k == 3 ? 255 : static_cast<std::uint8_t>(pixel_seed(i, k)));
  return pixels;
}

/// White boards of different tilt before dark walls, all around the eye: straight edges in every direction.
Scene make_boards() {
  Scene scene = test::make_room();
  for (Material& material : scene.materials) material.base_color = Vec4(0.05, 0.05, 0.06, 1), material.unlit = true;
  const int white = test::add_material(scene, Vec4(0.9, 0.9, 0.9, 1), AlphaMode::opaque, true);
  scene.materials.back().unlit = true;
  for (int i = 0; i < 24; ++i) {
    const double azimuth = 2.4 * i, elevation = 0.9 * std::sin(1.7 * i), tilt = 0.37 * i;
    const Vec3 forward(std::sin(azimuth) * std::cos(elevation), std::sin(elevation), -std::cos(azimuth) * std::cos(elevation));
    const Vec3 right = glm::normalize(glm::cross(forward, Vec3(0, 1, 0))), up = glm::cross(right, forward);
    const Vec3 u = 0.22 * (std::cos(tilt) * right + std::sin(tilt) * up), v = 0.22 * (std::cos(tilt) * up - std::sin(tilt) * right);
    test::add(scene, test::make_quad(0.7 * forward - 0.5 * (u + v), u, v, white));
  }
  return scene;
}

struct Display {
  SurfaceOptions options;
  Raster raster{400, 400};
};

struct Show {
  Pixels picture, seen, direct;
  EdgeReport edges;
};

Pixels trace(const Scene& scene, const View& view, const Surface& surface, const Raster& raster) {
  RayTraceOptions options;
  options.samples = 16;
  options.layers = Layers::colours;
  return colours(ray_trace(scene, view, surface, raster, options));
}

EdgeReport measure(const Pixels& picture, const Surface& surface, const EyeCamera& camera, const Pixels& direct, Pixels* seen = nullptr) {
  const Pixels view = simulate(picture, surface, camera, {});
  if (seen) *seen = view;
  const DisplayedPicture displayed(surface, {picture.width, picture.height});
  return compare_edges(view, direct, [&](const Vec2& p) { return displayed.pixel_inside(direction_through(camera, p.x, p.y)); });
}

Surface surface_of(const Display& display) { return Surface(display.options, screen_radius(display.raster)); }

Display curve(const std::string& f, std::optional<double> projector = std::nullopt) {
  Display display;
  display.options.curve = f;
  display.options.projector = projector;
  return display;
}

EyeCamera looking(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * std::numbers::pi / 180, e = elevation_deg * std::numbers::pi / 180;
  return {Vec3(std::sin(a) * std::cos(e), std::sin(e), -std::cos(a) * std::cos(e)), 60, {400, 300}};
}

TEST(Simulate, FlatDisplayShowsThePictureItself) {
  const Pixels picture = make_noise(64, 48);
  EyeCamera camera;
  camera.fov_deg = 90;
  camera.raster = {64, 48};
  SurfaceOptions flat;
  flat.curve = "1";
  SimulateOptions options;
  options.samples = 1;
  for (const PictureFilter filter : {PictureFilter::nearest, PictureFilter::linear}) {
    options.filter = filter;
    EXPECT_EQ(simulate(picture, Surface(flat, screen_radius(camera.raster)), camera, options).rgba, picture.rgba);
  }
}

TEST(Simulate, EyeSeesTheSceneItself) {
  const Scene scene = make_boards();
  Display equidistant;
  equidistant.options.lens = Lens::equidistant;
  for (const Display& display : {curve("1-r^2"), curve("3-sqrt(4+6*r^2)", 5), curve("1-r^2", 1), curve("1-r^2", 0.25),
                                 curve("2-(r+0.01)^r", 1), curve("sqrt(1-r^2)"), equidistant}) {
    const Surface surface = surface_of(display);
    const Pixels picture = trace(scene, View{}, surface, display.raster);
    std::size_t count = 0;
    for (const EyeCamera& camera : {looking(0, 0), looking(40, 10), looking(-30, -35)}) {
      const Pixels direct = trace(scene, turn_view(View{}, camera), flat_surface(camera), camera.raster);
      const EdgeReport edges = measure(picture, surface, camera, direct);
      const std::string name = display.options.curve + " azimuth " + std::to_string(camera.look.x);
      EXPECT_LE(edges.median, 0.1) << name; // the promise is 1
      EXPECT_LE(glm::length(edges.bias), 0.05) << name;
      EXPECT_GE(edges.within_pixel, 0.97) << name;
      count += edges.count;
    }
    EXPECT_GE(count, 300u) << display.options.curve;
  }
}

/// Where the light of every row first passes the middle between dark and bright, from left to right.
std::vector<Vec2> edge_points(const Pixels& pixels) {
  std::vector<Vec2> points;
  for (int row = 0; row < pixels.height; ++row)
    for (int column = 1; column < pixels.width; ++column) {
      const std::uint8_t* p = &pixels.rgba[4 * std::size_t(row * pixels.width + column)];
      if (p[-4] >= 140 || p[0] < 140) continue;
      points.push_back({column - 0.5 + (140.0 - p[-4]) / (p[0] - p[-4]), row + 0.5});
      break;
    }
  return points;
}

/// The largest distance from the straight line that fits best, px.
double bend(const std::vector<Vec2>& points) {
  double n = 0, y = 0, yy = 0, x = 0, xy = 0;
  for (const Vec2& p : points) ++n, y += p.y, yy += p.y * p.y, x += p.x, xy += p.x * p.y;
  const double slope = (n * xy - x * y) / (n * yy - y * y), start = (x - slope * y) / n;
  double most = 0;
  for (const Vec2& p : points) most = std::max(most, std::abs(p.x - start - slope * p.y) / std::hypot(1, slope));
  return most;
}

TEST(Simulate, StraightEdgesAreStraight) {
  Scene scene = test::make_room();
  for (Material& material : scene.materials) material.base_color = Vec4(0.02, 0.02, 0.02, 1), material.unlit = true;
  const int white = test::add_material(scene, Vec4(0.9, 0.9, 0.9, 1), AlphaMode::opaque, true);
  scene.materials.back().unlit = true;
  test::add(scene, test::make_quad({0.2, -1, -0.9}, {0.7, 0, 0}, {-0.1, 2, 0.2}, white)); // its left edge leans
  const EyeCamera camera = looking(25, 0);
  for (const Display& display : {curve("1-r^2"), curve("3-sqrt(4+6*r^2)", 5), curve("1-r^2", 1)}) {
    const Pixels picture = trace(scene, View{}, surface_of(display), {1200, 1200});
    const Pixels seen = simulate(picture, surface_of(display), camera, {});
    const std::vector<Vec2> edge = edge_points(seen);
    ASSERT_GE(edge.size(), 290u) << display.options.curve;
    EXPECT_LE(bend(edge), 0.35) << display.options.curve; // pixels of both pictures
    EXPECT_GT(bend(edge_points(picture)), 3) << "it is curved in the picture, or this test shows nothing";
    Display wrong = display;
    wrong.options.projector = display.options.projector.value_or(1) * 0.4;
    EXPECT_GT(bend(edge_points(simulate(picture, surface_of(wrong), camera, {}))), 0.7) << "a projector elsewhere bends it";
  }
}

TEST(Simulate, WrongProjectorOrShiftedPictureIsSeen) {
  const Scene scene = make_boards();
  const Display display = curve("3-sqrt(4+6*r^2)", 5);
  const Surface surface = surface_of(display);
  const Pixels picture = trace(scene, View{}, surface, display.raster);
  const EyeCamera camera = looking(20, 0);
  const Pixels direct = trace(scene, turn_view(View{}, camera), flat_surface(camera), camera.raster);
  EXPECT_GT(measure(picture, surface_of(curve("3-sqrt(4+6*r^2)", 3)), camera, direct).median, 1);
  EXPECT_GT(measure(picture, surface_of(curve("3-sqrt(4+6*r^2)")), camera, direct).median, 1);

  Pixels shifted = picture;
  for (std::size_t i = 0; i + 4 < picture.rgba.size(); ++i) shifted.rgba[i + 4] = picture.rgba[i]; // a column to the right
  const EdgeReport edges = measure(shifted, surface, camera, direct);
  EXPECT_NEAR(edges.bias.x, 1, 0.1);
  EXPECT_NEAR(edges.bias.y, 0, 0.1);
}

TEST(Simulate, NearestCrossingOfAFoldedDisplayIsSeen) {
  const Scene scene = make_boards();
  const Display display = curve("-0.1*r^4+2.25*r^2+0.2*cos(8*r)+1");
  const Surface surface = surface_of(display);
  ASSERT_GT(surface.branches().size(), 1u);
  const DisplayedPicture displayed(surface, display.raster);
  const ImageMap map = make_image_map(surface, Method::automatic);
  int several = 0;
  for (int i = 0; i < 200; ++i) {
    const double theta = 1.2 * i / 200;
    const Vec3 direction(std::sin(theta), 0, -std::cos(theta));
    const auto point = displayed.point(direction);
    double nearest = 1e9;
    int crossings = 0;
    for (std::size_t b = 0; b < surface.branches().size(); ++b)
      if (surface.shows(b, direction)) ++crossings, nearest = std::min(nearest, glm::length(*surface.meridian(surface.radius(b, direction))));
    ASSERT_EQ(point.has_value(), crossings > 0);
    if (!point) continue;
    EXPECT_NEAR(glm::length(*point), nearest, 1e-6);
    several += crossings > 1;
  }
  EXPECT_GT(several, 5);
  const EyeCamera camera = looking(0, 0);
  const Pixels picture = trace(scene, View{}, surface, display.raster);
  const Pixels direct = trace(scene, turn_view(View{}, camera), flat_surface(camera), camera.raster);
  EXPECT_LE(measure(picture, surface, camera, direct).median, 0.3);
}

TEST(Simulate, DirectViewIsAPinholeCamera) {
  Scene scene;
  const int white = test::add_material(scene, Vec4(1), AlphaMode::opaque, true);
  const Vec3 at(1, 2, -4); // 0.02 wide: a few pixels
  test::add(scene, test::make_quad(at - Vec3(0.01, 0.01, 0), Vec3(0.02, 0, 0), Vec3(0, 0.02, 0), white));
  EyeCamera camera;
  camera.look = Vec3(0, 0, -1);
  camera.fov_deg = 70;
  camera.raster = {900, 700};
  const Pixels direct = trace(scene, turn_view(View{}, camera), flat_surface(camera), camera.raster);
  Vec2 sum(0);
  double weight = 0;
  for (int i = 0; i < 900 * 700; ++i)
    if (const double a = direct.rgba[std::size_t(4 * i + 3)]; a > 0) sum += a * Vec2(i % 900 + 0.5, i / 900 + 0.5), weight += a;
  ASSERT_GT(weight, 0);
  const double focal = 350 / std::tan(35 * std::numbers::pi / 180);
  EXPECT_NEAR(sum.x / weight, 450 + focal * at.x / 4, 0.1);
  EXPECT_NEAR(sum.y / weight, 350 - focal * at.y / 4, 0.1);
}

TEST(Simulate, SameViewForAnyNumberOfThreads) {
  const Pixels picture = make_noise(128, 128);
  const Surface surface = surface_of(curve("1-r^2", 1));
  const EyeCamera camera = looking(30, 20);
  const Pixels all = simulate(picture, surface, camera, {});
  const ThreadLimit one(1);
  EXPECT_EQ(simulate(picture, surface, camera, {}).rgba, all.rgba);
}

TEST(Simulate, NothingIsSeenWhereTheDisplayEnds) {
  const Pixels picture = make_noise(128, 128);
  const Pixels behind = simulate(picture, surface_of(curve("sqrt(1-r^2)")), {Vec3(0, 0, 1), 60, {32, 32}}, {});
  for (std::size_t i = 3; i < behind.rgba.size(); i += 4) ASSERT_EQ(behind.rgba[i], 0);
}

TEST(Simulate, CameraOutOfRangeIsRefused) {
  const Pixels picture = make_noise(8, 8);
  const Surface surface = surface_of(curve("1-r^2"));
  EXPECT_THROW(simulate(picture, surface, {Vec3(0, 0, -1), 180, {8, 8}}, {}), Error);
  EXPECT_THROW(simulate(picture, surface, {Vec3(0), 60, {8, 8}}, {}), Error);
  EXPECT_THROW(simulate(picture, surface, {Vec3(0, 0, -1), 60, {8, 8}}, {PictureFilter::linear, 0}), Error);
}

TEST(Simulate, OutsideViewShowsDisplayCameraAndBeams) {
  Pixels picture = make_noise(64, 64);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) picture.rgba[i] = 0, picture.rgba[i + 1] = 0, picture.rgba[i + 2] = 255;
  const Pixels view = outside_view(picture, surface_of(curve("3-sqrt(4+6*r^2)", 5)), {}, {240, 180});
  std::size_t blue = 0, red = 0, yellow = 0;
  for (std::size_t i = 0; i < view.rgba.size(); i += 4) {
    const std::uint8_t* p = &view.rgba[i];
    ASSERT_EQ(p[3], 255);
    blue += p[0] < 10 && p[1] < 10 && p[2] > 245;
    red += p[0] > p[1] + 40 && p[1] < 60;
    yellow += p[0] > 200 && p[1] > 150 && p[2] < 120;
  }
  EXPECT_GT(blue, view.rgba.size() / 4 / 10);
  EXPECT_GT(red, 20u);
  EXPECT_GT(yellow, 20u);
}

/// A vertical step at `edge`, blurred over `blur` pixels.
Pixels make_step(double edge, double blur) {
  Pixels pixels{40, 8, {}};
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 40; ++x) {
      const double share = std::clamp((x + 0.5 - edge) / blur + 0.5, 0.0, 1.0), linear = 0.2 + 0.6 * share;
      const double srgb = 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
      for (int k = 0; k < 4; ++k) pixels.rgba.push_back(k == 3 ? 255 : static_cast<std::uint8_t>(std::lround(255 * srgb)));
    }
  return pixels;
}

TEST(Edges, MovedAndBlurredStepIsMeasured) {
  const auto twice = [](const Vec2& p) { return std::optional<Vec2>(2.0 * p); }; // a source of twice the resolution
  for (const double shift : {-1.25, -0.3, 0.0, 0.4, 1.0})
    for (const double blur : {1.0, 3.0}) { // whole pixels: others shift the sum of the samples
      const EdgeReport edges = compare_edges(make_step(20.2 + shift, blur), make_step(20.2, 1), twice);
      ASSERT_GT(edges.count, 0u);
      EXPECT_NEAR(edges.median, std::abs(2 * shift), 0.03);
      EXPECT_NEAR(edges.median_view_px, std::abs(shift), 0.015);
    }
  EXPECT_EQ(compare_edges(make_step(50, 1), make_step(50, 1), twice).count, 0u);
}

} // namespace
} // namespace domewarp
