// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>
#include <limits>
#include <vector>

namespace domewarp::bench {

/// Seconds that one call takes.
template <typename Work>
double seconds(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Processor time of one call, on all threads together: what one thread takes however busy the machine is.
template <typename Work>
double processor_seconds(Work&& work) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const double start = now();
  work();
  return now() - start;
}

/// The least time of each piece of work over some rounds in which all of them take turns, so that a noisy neighbour
/// cannot favour one.
inline std::vector<double> least_seconds(const std::vector<std::function<void()>>& works, int rounds) {
  std::vector<double> least(works.size(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < works.size(); ++i) least[i] = std::min(least[i], seconds(works[i]));
  return least;
}

} // namespace domewarp::bench
