// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/expression.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include "domewarp/profile/refuse.h"

namespace domewarp {

namespace {

struct NamedFunction {
  std::string_view name;
  Operation operation;
  int arguments;
};

constexpr std::array<NamedFunction, 18> functions{{
    {"sqrt", Operation::sqrt, 1},
    {"exp", Operation::exp, 1},
    {"ln", Operation::log, 1},
    {"log", Operation::log, 1},
    {"log10", Operation::log10, 1},
    {"sin", Operation::sin, 1},
    {"cos", Operation::cos, 1},
    {"tan", Operation::tan, 1},
    {"asin", Operation::asin, 1},
    {"acos", Operation::acos, 1},
    {"atan", Operation::atan, 1},
    {"sinh", Operation::sinh, 1},
    {"cosh", Operation::cosh, 1},
    {"tanh", Operation::tanh, 1},
    {"abs", Operation::abs, 1},
    {"min", Operation::min, 2},
    {"max", Operation::max, 2},
    {"pow", Operation::power, 2},
}};

constexpr std::string_view operand_wanted = "expected a number, r, pi, e, a function or '('";

std::string function_names() {
  std::string names;
  for (const NamedFunction& function : functions) names.append(names.empty() ? "" : " ").append(function.name);
  return names;
}

// <cctype> depends on the locale.
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

double rest_of(const Quad& exact, double value) { return static_cast<double>(exact - Quad(value)); }

class Parser {
public:
  explicit Parser(std::string_view text) : text_(text) {}

  Expression parse() {
    sum();
    skip_spaces();
    if (at_ < text_.size()) fail("expected an operator or the end");
    return {std::move(code_), deepest_};
  }

private:
  // One level of nesting; parentheses, function calls, signs and exponents recurse.
  struct Level {
    explicit Level(Parser& parser) : parser_(parser) {
      if (++parser_.depth_ > expression_depth_limit)
        parser_.fail("nested deeper than " + std::to_string(expression_depth_limit) + " levels");
    }
    ~Level() { --parser_.depth_; }
    Parser& parser_;
  };

  [[noreturn]] void fail(const std::string& what) const {
    std::string found = " but the text ends";
    if (at_ < text_.size()) {
      const char c = text_[at_];
      const bool printable = c > ' ' && c < 127;
      found = printable ? std::string(" but found '") + c + "'" : " but found a character that is not plain ASCII";
    }
    refuse("--curve", "column " + std::to_string(at_ + 1) + ": " + what + found);
  }

  void skip_spaces() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  }

  bool take(char c) {
    skip_spaces();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  void want(char c, const char* what) {
    if (!take(c)) fail(what);
  }

  void emit(Operation operation) { code_.push_back({operation}); }

  void push(const Instruction& operand) {
    code_.push_back(operand);
    deepest_ = std::max(deepest_, ++height_);
  }

  void push_constant(double value, const Quad& exact) { push({Operation::number, value, rest_of(exact, value), true}); }

  void pop_into(Operation operation) {
    emit(operation);
    --height_;
  }

  void sum() {
    product();
    for (;;) {
      if (take('+')) {
        product();
        pop_into(Operation::add);
      } else if (take('-')) {
        product();
        pop_into(Operation::subtract);
      } else {
        return;
      }
    }
  }

  void product() {
    signed_power();
    for (;;) {
      if (take('*')) {
        signed_power();
        pop_into(Operation::multiply);
      } else if (take('/')) {
        signed_power();
        divide();
      } else if (factor_follows()) {
        signed_power();
        pop_into(Operation::multiply);
      } else {
        return;
      }
    }
  }

  // a / tan(b) is continuous at the poles of tan; a * cot(b) says so.
  void divide() {
    if (code_.back().operation != Operation::tan) return pop_into(Operation::divide);
    code_.back().operation = Operation::cot;
    pop_into(Operation::multiply);
  }

  void signed_power() {
    const Level level(*this);
    if (take('-')) {
      signed_power();
      emit(Operation::negate);
    } else if (take('+')) {
      signed_power();
    } else {
      operand();
      if (take('^')) exponent();
    }
  }

  void exponent() {
    const std::size_t start = code_.size();
    signed_power();
    raise(start);
  }

  // A constant exponent gets the domain it deserves: all bases for integers, bases >= 0 for the others.
  void raise(std::size_t start) {
    const auto varies = [](const Instruction& instruction) { return instruction.operation == Operation::variable; };
    if (std::any_of(code_.begin() + static_cast<std::ptrdiff_t>(start), code_.end(), varies))
      return pop_into(Operation::power);
    Expression constant;
    constant.code.assign(code_.begin() + static_cast<std::ptrdiff_t>(start), code_.end());
    constant.stack_size = deepest_;
    const double value = evaluate(constant, 0);
    if (!std::isfinite(value)) fail("expected a finite exponent");
    const double rest = rest_of(differentiate(constant, Quad(0)).v, value);
    code_.resize(start);
    --height_;
    const bool integer = value == std::nearbyint(value) && std::abs(value) <= 1024;
    code_.push_back({integer ? Operation::power_int : Operation::power_number, value, rest});
  }

  void operand() {
    skip_spaces();
    if (at_ >= text_.size()) fail(std::string(operand_wanted));
    const char c = text_[at_];
    if (is_digit(c) || c == '.') return number();
    if (is_letter(c)) return name();
    if (!take('(')) fail(std::string(operand_wanted));
    sum();
    want(')', "expected an operator or ')'");
    factor_end_ = at_;
  }

  void number() {
    double value = 0;
    const char* first = text_.data() + at_;
    const auto [end, status] = std::from_chars(first, text_.data() + text_.size(), value);
    if (status == std::errc::result_out_of_range) fail("expected a number within the range of a double");
    if (status != std::errc()) fail(std::string(operand_wanted));
    const std::string_view digits = text_.substr(at_, static_cast<std::size_t>(end - first));
    at_ += digits.size();
    factor_end_ = at_;
    push_constant(value, parse_quad(digits));
  }

  // 2.5r^2, 0.2cos(8r), r^2(1+r), r(r+1): a product without a sign.
  bool factor_follows() const {
    return at_ > 0 && at_ == factor_end_ && at_ < text_.size() && (is_letter(text_[at_]) || text_[at_] == '(');
  }

  void name() {
    const std::size_t start = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    const std::string_view word = text_.substr(start, at_ - start);
    factor_end_ = at_;
    if (word == "r") return push({Operation::variable});
    if (word == "pi") return push_constant(std::numbers::pi, quad_pi());
    if (word == "e") return push_constant(std::numbers::e, quad_e());
    const auto found = std::find_if(functions.begin(), functions.end(),
                                    [word](const NamedFunction& function) { return function.name == word; });
    if (found != functions.end()) return call(*found);
    refuse("--curve", "column " + std::to_string(start + 1) + ": " + std::string(operand_wanted) +
                          " but found the name '" + std::string(word.substr(0, 32)) + "'; functions are " + function_names());
  }

  void call(const NamedFunction& function) {
    want('(', "expected '(' after the name of a function");
    sum();
    const std::size_t second = code_.size();
    if (function.arguments == 2) {
      want(',', "expected ',' and a second argument");
      sum();
    }
    want(')', "expected an operator or ')'");
    factor_end_ = at_;
    if (function.operation == Operation::power) return raise(second);
    if (function.arguments == 2) return pop_into(function.operation);
    emit(function.operation);
  }

  std::string_view text_;
  std::size_t at_ = 0, factor_end_ = 0;
  int depth_ = 0;
  std::vector<Instruction> code_;
  std::size_t height_ = 0, deepest_ = 0;
};

} // namespace

Expression compile(std::string_view text) {
  if (text.size() > expression_length_limit)
    refuse("--curve", "the expression has " + std::to_string(text.size()) + " characters, more than " +
                          std::to_string(expression_length_limit));
  return Parser(text).parse();
}

} // namespace domewarp
