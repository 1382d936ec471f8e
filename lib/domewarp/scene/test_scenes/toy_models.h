// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "domewarp/scene/test_scenes/shape.h"

/// The toys of the scene "toys". Each stands on y = 0 and looks along +z, vehicles along +x.
namespace domewarp::test_scenes {

struct EngineColors {
  int boiler, cab, trim, dark, lamp;
};

Shape engine(const EngineColors& colors);
Shape wagon(int chassis, int walls, int load);
/// Lies on its side: the axle is the y axis.
Shape wheel(double radius, int material);
/// Two rails around the origin on wooden sleepers.
Shape track(double radius, double gauge, int sleepers, int rail, int wood);

Shape bowling_pin(int material);
Shape stacking_pole(int wood, int tip);
Shape bookshelf(double width, double height, int material);
Shape dolls_house(int front, int wall, int roof, int chimney, int fence);
Shape xylophone_frame(int bars, int material);
Shape mallet(int stick, int head);
Shape drum(int shell, int skin, int rim);
Shape spinning_top(int material, int metal);
Shape rocket(int body, int fin, int glass);
Shape robot(int body, int joint, int eye);
struct TeddyColors {
  int fur, snout, black;
};
Shape teddy(const TeddyColors& colors);
/// A diamond with a tail, hanging in the xy plane.
Shape kite(int cloth);

double bar_length(int bar);
Mat4 bar_place(int bar, int bars);

} // namespace domewarp::test_scenes
