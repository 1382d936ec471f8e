// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/refuse.h"

#include <array>
#include <charconv>
#include <cmath>

#include "domewarp/core/errors.h"

namespace domewarp {

std::string to_text(double value) {
  if (std::isnan(value)) return "nan";
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

void refuse(std::string_view option, std::string_view what) {
  throw Error(ErrorCode::usage, std::string(option) + ": " + std::string(what));
}

} // namespace domewarp
