// SPDX-License-Identifier: Apache-2.0
#include "domewarp/core/memory.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include <malloc.h>
#include <sys/resource.h>

#include "domewarp/core/errors.h"

namespace domewarp {

std::uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

void limit_memory(std::uint64_t bytes) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::usage, "--max-memory: " + std::to_string(bytes >> 20) + " MiB " + why);
  };
  if (peak_memory() > bytes) refuse("is less than the program itself has in use");
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  limit.rlim_cur = limit.rlim_max == RLIM_INFINITY ? bytes : std::min<rlim_t>(bytes, limit.rlim_max);
  if (setrlimit(RLIMIT_DATA, &limit) != 0) refuse(std::string("cannot be set: ") + std::strerror(errno));
}

void keep_free_memory() {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
}

void release_free_memory() { malloc_trim(0); }

} // namespace domewarp
