// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "domewarp/core/errors.h"

namespace domewarp::bench {

/// What a piece of work told, and the peak of memory of the process it ran in.
template <typename Told>
struct Measured : Told {
  double peak_bytes = 0;
};

/// Runs the work in a process of its own, so that its peak of memory is its own too. This process must have no threads.
/// @param work returns a trivially copyable struct
template <typename Work>
Measured<std::invoke_result_t<Work>> in_child(Work&& work) {
  using Told = std::invoke_result_t<Work>;
  static_assert(std::is_trivially_copyable_v<Told>);
  int ends[2];
  if (pipe(ends) != 0) throw domewarp::Error(ErrorCode::output, "a pipe cannot be made");
  const pid_t child = fork();
  if (child < 0) throw domewarp::Error(ErrorCode::output, "a process cannot be started");
  if (child == 0) {
    const Told told = work();
    const bool sent = ::write(ends[1], &told, sizeof told) == static_cast<ssize_t>(sizeof told);
    _exit(sent ? 0 : 1);
  }
  close(ends[1]);
  Measured<Told> measured;
  const bool received = ::read(ends[0], static_cast<Told*>(&measured), sizeof(Told)) == static_cast<ssize_t>(sizeof(Told));
  close(ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (!received || status != 0) throw domewarp::Error(ErrorCode::output, "a measured process failed");
  measured.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  return measured;
}

} // namespace domewarp::bench
