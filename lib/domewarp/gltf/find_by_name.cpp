// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/find_by_name.h"

#include <algorithm>
#include <charconv>

#include "domewarp/core/errors.h"

namespace domewarp::gltf {

std::size_t find_by_name(const std::string& name, const std::vector<std::string>& names, const char* option,
                         const char* what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::size_t index = 0;
  const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), index);
  if (status == std::errc() && end == name.data() + name.size() && index < names.size()) return index;
  throw Error(ErrorCode::usage, std::string(option) + " " + name + ": the file has " + std::to_string(names.size()) +
                                    " " + what + "(s) and none of that name or index");
}

} // namespace domewarp::gltf
