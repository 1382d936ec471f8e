// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: whatever the text, compile() gives an expression or throws Error, and an expression can be evaluated
// as numbers, derivatives and enclosures; the enclosure holds the value where it says that f is defined.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "domewarp/core/errors.h"
#include "domewarp/profile/expression.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace domewarp;
  try {
    const Expression expression = compile({reinterpret_cast<const char*>(data), size});
    const double r = 0.37;
    const double value = evaluate(expression, r);
    const Jet<Interval> cell = enclose_jet(expression, Interval(r, 0.38));
    differentiate(expression, r);
    differentiate(expression, Quad(r));
    if (cell.v.regularity != Regularity::unknown && std::isfinite(value) && !contains(cell.v, value)) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
