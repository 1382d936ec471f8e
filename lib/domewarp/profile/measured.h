// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "domewarp/core/vectors.h"
#include "domewarp/profile/jet.h"

namespace domewarp {

/// Rows "r z" of a text file; blank lines and lines that start with # are skipped, numbers may be separated by spaces,
/// tabs, a comma or a semicolon.
/// @return (r, z), r strictly increasing from 0, at least two rows.
/// @throws Error(input) naming the file, the line and what is wrong with it.
std::vector<Vec2> read_profile(const std::filesystem::path& path);

/// A cubic through measured points that overshoots none of them and is monotone wherever they are.
struct MeasuredCurve {
  std::vector<double> r, z, slope; ///< knots, ascending in r
};

/// @param rows (r, z) as read_profile() promises them. @param name for messages.
/// @throws Error(usage) when the rows are not as promised.
MeasuredCurve fit_measured(const std::vector<Vec2>& rows, const std::string& name);

/// NaN outside the knots.
double evaluate(const MeasuredCurve& curve, double r);
Jet<double> differentiate(const MeasuredCurve& curve, double r);
Jet<Quad> differentiate(const MeasuredCurve& curve, const Quad& r);
/// The cell must lie between two neighbouring knots.
Jet<Interval> enclose_jet(const MeasuredCurve& curve, const Interval& cell);

} // namespace domewarp
