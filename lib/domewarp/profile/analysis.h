// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "domewarp/profile/curve.h"

namespace domewarp {

/// Largest e <= limit such that f is defined and continuous on [0, e], to the last bit: from interval enclosures, with
/// single values deciding only within a few ulp of where enclosures cannot.
/// @throws Error(usage) when the curve is too irregular to be analysed (also for the functions below).
double find_domain_end(const Curve& curve, double limit);

/// Points inside (0, end) where f is continuous but not smooth: kinks, vertical tangents, joints of pieces; ascending.
std::vector<double> find_kinks(const Curve& curve, double end);

/// Points inside (0, end) where h(r) + offset changes sign, h = f - r f'; ascending. With offset 0 they are the folds
/// of the view angle, with the projector's distance those of the compensated image radius.
std::vector<double> find_folds(const Curve& curve, double end, double offset);

/// h(r) = f - r f'; h > 0 where the image radius rises with the view angle.
double fold_function(const Curve& curve, double r);

} // namespace domewarp
