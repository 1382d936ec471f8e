// SPDX-License-Identifier: Apache-2.0
// The negative control of the sanitized tests: reads past the end of what was allocated, or overflows an int.
// Usage: planted_overflow heap|int
#include <climits>
#include <cstring>
#include <vector>

int main(int count, char** arguments) {
  if (count < 2) return 0;
  if (std::strcmp(arguments[1], "int") == 0) return INT_MAX - 1 + count == 0;
  const std::vector<int> values(static_cast<std::size_t>(count));
  return values.data()[count] == 42;
}
