// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "domewarp/profile/jet.h"
#include "domewarp/profile/rounded.h"

namespace domewarp {

enum class Operation : unsigned char {
  // clang-format off
  number, variable,
  negate, sqrt, exp, log, log10, sin, cos, tan, cot, asin, acos, atan, sinh, cosh, tanh, abs, power_int, power_number,
  add, subtract, multiply, divide, power, min, max, // two operands
  // clang-format on
};

struct Instruction {
  Operation operation{};
  double number = 0;    ///< the constant, or the exponent of power_int and power_number
  double rest = 0;      ///< what the decimal, pi or e is more than `number`, to 30 digits
  bool rounded = false; ///< the constant stands for a decimal that may not be a double
};

/// An expression in r, compiled to postfix code. Immutable; evaluation is thread-safe and never throws: outside the
/// domain values are NaN or infinite, and enclosures of unknown regularity.
struct Expression {
  std::vector<Instruction> code;
  std::size_t stack_size = 0; ///< operands on the stack at most
};

inline constexpr std::size_t expression_length_limit = 4096;
inline constexpr int expression_depth_limit = 256;

/// Infix in r: + - * / ^ (right associative, binding tighter than unary minus), parentheses, sqrt exp ln log log10 sin
/// cos tan asin acos atan sinh cosh tanh abs min max pow, pi, e. A number written straight before a name or a
/// parenthesis multiplies it: 2.5r^2. Numbers are read the same way in every locale.
/// @throws Error(usage) that names the column (from 1) and what was expected there, or the limit exceeded.
Expression compile(std::string_view text);

double evaluate(const Expression& expression, double r);
/// The same with a bound of its rounding.
Rounded evaluate_rounded(const Expression& expression, double r);
/// f, f', f''.
Jet<double> differentiate(const Expression& expression, double r);
Jet<Quad> differentiate(const Expression& expression, const Quad& r);
/// Enclosures of f over the cell.
Interval enclose(const Expression& expression, const Interval& r);
/// Enclosures of f, f', f'' over the cell.
Jet<Interval> enclose_jet(const Expression& expression, const Interval& r);

} // namespace domewarp
