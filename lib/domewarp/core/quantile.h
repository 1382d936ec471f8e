// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace domewarp {

/// The smallest of the values that at most one in `one_in` others lie above: 2 for the (lower) median, 100 for 99 %,
/// 1000 for 99.9 %. By nearest rank, so it is always one of the values.
/// @param values at least one, none of them NaN; they are reordered
/// @param one_in at least 1
template <typename Number>
Number quantile(std::vector<Number>& values, std::size_t one_in) {
  assert(!values.empty() && one_in >= 1);
  const std::size_t rank = values.size() - 1 - std::min(values.size() / one_in, values.size() - 1);
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

} // namespace domewarp
