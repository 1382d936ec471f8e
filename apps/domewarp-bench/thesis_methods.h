// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "domewarp/profile/curve.h"
#include "domewarp/transform/batch.h"

namespace domewarp::bench {

/// The thesis' direct method (Eq. 9 to 13): bisection of f(r) = m r to 1e-6, the expression evaluated at each step.
void map_by_bisection(const Curve& curve, double r_max, const ConstPoints& in, const Points& out, std::size_t count);

/// The thesis' table (Eq. 17): radii every 0.05 degrees, the nearest one taken through an arctangent.
struct ThesisTable {
  std::vector<float> radii;
};
ThesisTable make_thesis_table(const Curve& curve, double r_max);
void map_by_thesis_table(const ThesisTable& table, const ConstPoints& in, const Points& out, std::size_t count);

} // namespace domewarp::bench
