// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "domewarp/scene/test_scenes/shape.h"

/// What floats about in the scene "biology".
namespace domewarp::test_scenes {

struct DnaColors {
  std::array<int, 2> strands;
  std::array<int, 4> bases; ///< adenine, thymine, guanine, cytosine
};

/// A double helix whose axis is a half circle in the xy plane, from +x over +y to -x.
Shape dna_arch(double arch_radius, const DnaColors& colors);

/// Half a ball with a thick wall, open towards +y.
Shape bowl(double radius, double thickness, int sides, int rings, int outer, int inner);

struct CellColors {
  int membrane, cytoplasm, nucleus, nucleolus, golgi, vesicle;
};
/// Cut open towards +y.
Shape animal_cell(double radius, const CellColors& colors);
/// Cut open towards +y, long along x.
Shape mitochondrion(int outer, int inner, int crista);
/// With a spike on each vertex and each face of an icosahedron.
Shape virus(double radius, int capsid, int spike);
Shape red_blood_cell(double radius, int material);
Shape white_blood_cell(double radius, int material);
/// Swims along +y, its flagella behind it.
Shape bacterium(int body, int flagellum);
/// A pill box of glass with holes.
Shape diatom(double radius, double height, int shell);
/// Soma at the origin. @param axon the way of the axon from there
Shape neuron(const std::vector<Vec3>& axon, int body, int sheath);

} // namespace domewarp::test_scenes
