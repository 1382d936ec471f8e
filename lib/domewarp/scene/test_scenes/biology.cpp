// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <glm/geometric.hpp>

#include "domewarp/scene/test_scenes/organisms.h"
#include "domewarp/scene/test_scenes/scenes.h"
#include "domewarp/scene/test_scenes/solids.h"
#include "domewarp/scene/test_scenes/stage.h"

namespace domewarp::test_scenes {

namespace {

/// The deep: light from above, pale mist.
Picture plasma() {
  return paint(256, 256, 3, [](double u, double v) {
    const Vec4 depth = mix(rgb(0x5fc6d6), rgb(0x0b2a4d), ramp(0, 0.42, v));
    const Vec4 mist = mix(depth, rgb(0x8a4f86), ramp(0.3, 0.56, v) * 0.9);
    return mix(mist, rgb(0xbfe8ff), 0.4 * ramp(0.45, 0.85, clouds(u, v, 8, 12)) * ramp(0.02, 0.2, v));
  });
}

/// Tissue below, a dome of 15 m above.
Shape surroundings(Scene& scene) {
  const int tissue = add_textured(scene, "tissue", cells(256, 6, rgb(0xe39a92), rgb(0x8e3b4e), 44), 0.7);
  const int fluid = add_unlit(scene, "plasma", plasma());
  std::vector<Vec2> profile = {{0, 0}};
  for (int i = 0; i <= 6; ++i) profile.push_back(15.0 * circle(i / 24.0));
  const Shape shape = turned_inside_out(painted(lathe(profile, 24), fluid));
  Shape result = painted_towards(shape, {0, 1, 0}, 0.999, tissue);
  for (Face& face : result)
    if (face.material == tissue) face = with_box_uvs({face}, Vec3(5)).front();
  return result;
}

void add_dna(Scene& scene) {
  const std::array<int, 2> strands = {add_plain(scene, "strand", 0x2f7fd6, 0.35),
                                      add_plain(scene, "counterstrand", 0xe8902e, 0.35)};
  const std::array<int, 4> bases = {
      add_plain(scene, "adenine", 0x3fae5a, 0.5), add_plain(scene, "thymine", 0xd9443a, 0.5),
      add_plain(scene, "guanine", 0xf1cf3c, 0.5), add_plain(scene, "cytosine", 0x8d5bc4, 0.5)};
  add_object(scene, "DNA", dna_arch(6.4, {strands, bases}), shift(0, -0.4, -4.6) * turn({0, 1, 0}, 8));
}

void add_cell(Scene& scene) {
  const CellColors colors{add_textured(scene, "membrane", cells(128, 12, rgb(0x9ad8c5), rgb(0x3b8f84), 5), 0.5),
                          add_plain(scene, "cytoplasm", 0xd9f0d8, 0.8),
                          add_textured(scene, "nucleus", cells(128, 10, rgb(0x8a64c8), rgb(0x4c2f86), 8), 0.5),
                          add_plain(scene, "nucleolus", 0x3b1f66, 0.5),
                          add_plain(scene, "Golgi apparatus", 0xf2a65a, 0.45),
                          add_plain(scene, "vesicle", 0xe8d23f, 0.4)};
  add_object(scene, "cell", animal_cell(1.25, colors),
             shift(1.5, 1.75, -2.3) * turn({0, 1, 0}, -35) * turn({1, 0, 0}, 58));
}

void add_mitochondria(Scene& scene) {
  const int outer = add_textured(scene, "outer membrane", speckled(64, rgb(0xe4744f), rgb(0xb8452f), 16, 3), 0.5);
  const int inner = add_plain(scene, "matrix", 0xf6c59a, 0.7), crista = add_plain(scene, "crista", 0xc2452f, 0.5);
  const int mesh = add_mesh(scene, "mitochondrion", mitochondrion(outer, inner, crista));
  add_instance(scene, "mitochondrion", mesh, shift(-1.35, 0.95, -1.9) * turn({0, 1, 0}, 20) * turn({1, 0, 0}, 48));
  add_instance(scene, "far mitochondrion", mesh, shift(3.6, 1.2, 0.9) * turn({0, 1, 0}, -80) * turn({1, 0, 0}, 50));
}

void add_viruses(Scene& scene) {
  const int capsid = add_plain(scene, "capsid", 0x6fa34a, 0.5), spike = add_plain(scene, "spike", 0xd6336c, 0.4);
  const int mesh = add_mesh(scene, "virus", virus(0.55, capsid, spike));
  add_instance(scene, "virus", mesh, shift(-0.5, 3.0, -3.1) * turn({1, 0, 1}, 25));
  add_instance(scene, "far virus", mesh, shift(4.3, 3.4, -1.6) * turn({0, 1, 1}, 70));
}

void add_blood(Scene& scene) {
  const int red = add_plain(scene, "haemoglobin", 0xb81f24, 0.35);
  const int mesh = add_mesh(scene, "red blood cell", red_blood_cell(0.62, red));
  add_instance(scene, "red blood cell 1", mesh, shift(-2.9, 3.7, -2.6) * turn({1, 0, 0.4}, 55));
  add_instance(scene, "red blood cell 2", mesh, shift(3.4, 1.0, -4.2) * turn({1, 0, -0.5}, 35));
  add_instance(scene, "red blood cell 3", mesh, shift(1.1, 3.9, 0.3) * turn({0.3, 0, 1}, 40));
  add_instance(scene, "red blood cell 4", mesh, shift(-1.9, 0.8, 1.9) * turn({1, 0, 0.8}, 65));
  const int pale = add_textured(scene, "leucocyte", speckled(128, rgb(0xf1ebe4), rgb(0xc9b8d6), 8, 19), 0.6);
  add_object(scene, "white blood cell", white_blood_cell(1.15, pale), shift(3.2, 1.5, 3.6));
}

/// Round holes in rows, nearer to each other towards the middle.
Picture sieve() {
  return paint(64, 64, 4, [](double u, double v) {
    const double x = u * 2 - std::floor(u * 2) - 0.5, y = v * 2 - std::floor(v * 2) - 0.5;
    Vec4 color = mix(rgb(0xcdeef5), rgb(0x6fb2c9), clouds(u, v, 8, 6));
    color.w = x * x + y * y < 0.085 ? 0 : 1;
    return color;
  });
}

void add_microbes(Scene& scene) {
  const int body = add_textured(scene, "cell wall", speckled(64, rgb(0x5bbf8a), rgb(0x2b7f66), 16, 33), 0.5);
  const int hair = add_plain(scene, "flagellum", 0xa8e6c4, 0.6);
  add_object(scene, "bacterium", bacterium(body, hair),
             shift(-0.2, 0.7, -1.2) * turn({0, 1, 0}, -35) * turn({0, 0, 1}, -76));
  add_object(scene, "diatom", diatom(0.85, 0.5, add_cutout(scene, "silica", sieve(), 0.2)),
             shift(-3.6, 1.3, 2.1) * turn({1, 0, 0.6}, 60));
}

/// Bright at the soma, cooler along the branches.
void add_neuron(Scene& scene) {
  const int body = add_plain(scene, "neuron", 0xffffff, 0.45), sheath = add_plain(scene, "myelin", 0xfff6d8, 0.5);
  const std::vector<Vec3> axon = {{0.3, 0, 0.2},   {1.4, 0.9, 1.2}, {2.4, 1.9, 2.8},
                                  {4.4, 2.3, 4.6}, {6.8, 1.4, 5.8}, {9, -0.5, 5.2}};
  const auto color = [](const Vec3& p) {
    return mix(Vec4(1, 0.82, 0.35, 1), Vec4(0.45, 0.3, 0.85, 1), ramp(0.3, 2.6, std::sqrt(glm::dot(p, p))));
  };
  add_object(scene, "neuron", neuron(axon, body, sheath), shift(-4, 2.4, -1.6),
             [color](const Vec3& p) { return Vec3(color(p)); });
}

} // namespace

Scene make_biology() {
  Scene scene;
  add_object(scene, "surroundings", surroundings(scene));
  add_dna(scene);
  add_cell(scene);
  add_mitochondria(scene);
  add_viruses(scene);
  add_blood(scene);
  add_microbes(scene);
  add_neuron(scene);
  add_camera(scene, "diver", {0, 1.7, 1.1}, {-0.05, 1.85, -3}, 75);
  add_camera(scene, "overview", {5.5, 4.5, 7.5}, {-0.6, 1.6, -1.5}, 60);
  add_sun(scene, "surface light", {2, 9, 3}, 0xf2fbff, 1.7);
  add_point_light(scene, "lamp", {0.2, 2.6, 1.8}, 0xfff2dd, 10);
  add_point_light(scene, "glow", {-3, 1.2, -4}, 0x9fd8ff, 9);
  return scene;
}

} // namespace domewarp::test_scenes
