// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace domewarp {

/// Limits the number of threads for everything below the caller's frame while the object lives. 0 means all.
class ThreadLimit {
public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
  void* control_;
};

/// Calls body() so that the parallel loops inside it use at most this many threads, whatever others do meanwhile.
void with_threads(int threads, const std::function<void()>& body);

/// Calls body(begin, end) on disjoint ranges that cover [0, count), in parallel, at least `grain` items each.
/// The split into ranges may differ from run to run: the body must not let it reach a result.
void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Calls body(i) for every i in [0, count), in parallel.
template <typename Body>
void parallel_each(std::size_t count, std::size_t grain, Body&& body) {
  parallel_ranges(count, grain, [&body](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

} // namespace domewarp
