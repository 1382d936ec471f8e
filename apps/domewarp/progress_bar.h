// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "domewarp/core/progress.h"

namespace domewarp {

/// One line on the terminal that says how far long work has come; nothing at all when standard error is no terminal or
/// `quiet`. Safe to use from several threads.
class ProgressBar {
public:
  explicit ProgressBar(bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// A callback that shows the stage it is told of; valid while the bar lives, empty when the bar shows nothing.
  Progress watch();

  /// Shows `label`, a bar, and `note` behind it; without a note the time spent since the label changed and the time left.
  /// @param done 0 to 1, negative when it cannot be known
  void show(const std::string& label, double done, const std::string& note);

  /// Removes the line, so that something else can be printed; the next `show` brings it back.
  void clear();

  double seconds() const; ///< since the bar was made

private:
  using Clock = std::chrono::steady_clock;

  std::string time_note(double done) const;

  std::mutex guard_;
  const bool visible_;
  bool drawn_ = false;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point last_, stage_start_ = start_;
  std::string stage_;
};

/// 75 -> "1:15", for people.
std::string to_clock(double seconds);

} // namespace domewarp
