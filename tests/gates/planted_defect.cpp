// SPDX-License-Identifier: Apache-2.0
// The negative control of the gate clang_tidy: every check family it relies on must find something here. Never built.
#include <string>
#include <utility>
#include <vector>

int planted(std::vector<std::string> names) {                // performance-unnecessary-value-param
  std::string moved = std::move(names[0]);
  for (const std::string name : names) moved += name;        // performance-for-range-copy
  std::vector<std::string> taken = std::move(names);
  int unset;                                                 // cppcoreguidelines-init-variables
  if (names.size() == 0) unset = 1;                          // bugprone-use-after-move, readability-container-size-empty
  else unset = 1;                                            // bugprone-branch-clone
  const char* none = 0;                                      // modernize-use-nullptr
  return unset + (none == none) + static_cast<int>(taken.size()); // misc-redundant-expression
}
