// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "domewarp/profile/expression.h"

namespace domewarp {

namespace {

double constant(const Instruction& instruction, double*) { return instruction.number; }
Quad constant(const Instruction& instruction, Quad*) { return Quad(instruction.number) + Quad(instruction.rest); }
Interval constant(const Instruction& instruction, Interval*) {
  return instruction.rounded ? around(instruction.number) : Interval(instruction.number);
}
Rounded constant(const Instruction& instruction, Rounded*) {
  return {instruction.number, instruction.rounded ? rounded_rules::ulp * std::abs(instruction.number) : 0};
}
template <typename T>
Jet<T> constant(const Instruction& instruction, Jet<T>*) {
  return {constant(instruction, static_cast<T*>(nullptr)), T(0), T(0)};
}

// The exponent of power_number as each kind of number takes it; intervals allow for its rounding themselves.
template <typename T>
double exponent(const Instruction& instruction, T*) {
  return instruction.number;
}
Rounded exponent(const Instruction& instruction, Rounded* unused) { return constant(instruction, unused); }
Quad exponent(const Instruction& instruction, Jet<Quad>*) { return constant(instruction, static_cast<Quad*>(nullptr)); }

double larger(double a, double b) { return std::isnan(a) || std::isnan(b) ? a + b : std::max(a, b); }
template <typename T>
T larger(const T& a, const T& b) {
  return max(a, b);
}

template <typename T>
T raised(const T& base, const T& exponent) {
  return power(base, exponent);
}

template <typename T>
T apply(Operation operation, const T& a) {
  using std::abs, std::acos, std::asin, std::atan, std::cos, std::cosh, std::exp, std::log, std::log10, std::sin,
      std::sinh, std::sqrt, std::tan, std::tanh;
  switch (operation) {
  case Operation::negate: return -a;
  case Operation::sqrt: return sqrt(a);
  case Operation::exp: return exp(a);
  case Operation::log: return log(a);
  case Operation::log10: return log10(a);
  case Operation::sin: return sin(a);
  case Operation::cos: return cos(a);
  case Operation::tan: return tan(a);
  case Operation::cot: return cot(a);
  case Operation::asin: return asin(a);
  case Operation::acos: return acos(a);
  case Operation::atan: return atan(a);
  case Operation::sinh: return sinh(a);
  case Operation::cosh: return cosh(a);
  case Operation::tanh: return tanh(a);
  default: return abs(a);
  }
}

template <typename T>
T combine(Operation operation, const T& a, const T& b) {
  switch (operation) {
  case Operation::add: return a + b;
  case Operation::subtract: return a - b;
  case Operation::multiply: return a * b;
  case Operation::divide: return a / b;
  case Operation::power: return raised(a, b);
  case Operation::min: return -larger(T(-a), T(-b));
  default: return larger(a, b);
  }
}

bool is_binary(Operation operation) { return operation >= Operation::add; }

template <typename T>
T run(const Expression& expression, const T& r, T* stack) {
  T* top = stack - 1;
  for (const Instruction& instruction : expression.code) {
    switch (instruction.operation) {
    case Operation::number:
      ++top;
      *top = constant(instruction, top);
      break;
    case Operation::variable: *++top = r; break;
    case Operation::power_int: *top = power(*top, static_cast<int>(instruction.number)); break;
    case Operation::power_number: *top = power(*top, exponent(instruction, top)); break;
    default:
      if (is_binary(instruction.operation)) {
        --top;
        *top = combine(instruction.operation, top[0], top[1]);
      } else {
        *top = apply(instruction.operation, *top);
      }
    }
  }
  return *top;
}

template <typename T>
T run(const Expression& expression, const T& r) {
  constexpr std::size_t usual_size = 16;
  if (expression.stack_size <= usual_size) {
    std::array<T, usual_size> stack;
    return run(expression, r, stack.data());
  }
  std::vector<T> stack(expression.stack_size);
  return run(expression, r, stack.data());
}

} // namespace

double evaluate(const Expression& expression, double r) { return run(expression, r); }

Rounded evaluate_rounded(const Expression& expression, double r) { return run(expression, Rounded{r}); }

Jet<double> differentiate(const Expression& expression, double r) { return run(expression, Jet<double>{r, 1, 0}); }

Jet<Quad> differentiate(const Expression& expression, const Quad& r) { return run(expression, Jet<Quad>{r, 1, 0}); }

Interval enclose(const Expression& expression, const Interval& r) { return run(expression, r); }

Jet<Interval> enclose_jet(const Expression& expression, const Interval& r) {
  return run(expression, Jet<Interval>{r, Interval(1), Interval(0)});
}

} // namespace domewarp
