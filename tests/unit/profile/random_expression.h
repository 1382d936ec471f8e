// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <string>

namespace domewarp {

/// A random expression that both muParser and ours read alike.
inline std::string random_text(std::mt19937_64& random, int depth) {
  const auto pick = [&](int count) { return static_cast<int>(random() % static_cast<unsigned>(count)); };
  if (depth == 0) {
    static const char* leaves[] = {"r", "r", "1.5", ".25", "3", "pi", "e", "2e-1"};
    return leaves[pick(8)];
  }
  const std::string a = random_text(random, depth - 1), b = random_text(random, pick(depth));
  static const char* functions[] = {"sqrt", "exp",  "ln",   "log10", "sin",  "cos",  "tan",
                                    "asin", "acos", "atan", "sinh",  "cosh", "tanh", "abs"};
  switch (pick(10)) {
  case 0: return a + "+" + b;
  case 1: return a + " - " + b;
  case 2: return a + "*" + b;
  case 3: return "(" + a + ")/(" + b + ")";
  case 4: return "(-" + a + ")";
  case 5: return "(" + a + ")^2";
  case 6: return "abs(" + a + ")^(r/(1+abs(" + b + ")))";
  case 7: return "min(" + a + "," + b + ")";
  case 8: return "max(" + a + ", (" + b + "))";
  default: return std::string(functions[pick(14)]) + "(" + a + ")";
  }
}

} // namespace domewarp
