// SPDX-License-Identifier: Apache-2.0
#include "machine.h"

#include <fstream>
#include <thread>

namespace domewarp::bench {

namespace {

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown CPU";
}

std::string instruction_set() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512vl")) return "AVX-512";
  if (__builtin_cpu_supports("avx2")) return "AVX2";
  if (__builtin_cpu_supports("sse4.2")) return "SSE4.2";
  return "SSE2";
#else
  return "not x86-64";
#endif
}

std::string compiler() {
#if defined(__clang__)
  return "clang " + std::to_string(__clang_major__);
#else
  return std::string("GCC ") + __VERSION__;
#endif
}

} // namespace

std::string machine() {
  const unsigned cores = std::thread::hardware_concurrency();
  return cpu_name() + ", " + instruction_set() + ", " + std::to_string(cores) + " cores, " + compiler();
}

} // namespace domewarp::bench
