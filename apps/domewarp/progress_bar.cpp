// SPDX-License-Identifier: Apache-2.0
#include "progress_bar.h"

#include <algorithm>
#include <cstdio>
#include <iostream>

#include <sys/ioctl.h>
#include <unistd.h>

namespace domewarp {

namespace {

constexpr std::chrono::milliseconds least_pause(100);
constexpr int bar_width = 24;

std::size_t terminal_width() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string draw_bar(double done) {
  if (done < 0) return "";
  const int filled = static_cast<int>(std::clamp(done, 0.0, 1.0) * bar_width);
  char percent[16];
  std::snprintf(percent, sizeof percent, "] %3d %%  ", static_cast<int>(std::clamp(done, 0.0, 1.0) * 100));
  std::string bar(1, '[');
  bar.append(static_cast<std::size_t>(filled), '#').append(static_cast<std::size_t>(bar_width - filled), '.').append(percent);
  return bar;
}

} // namespace

std::string to_clock(double seconds) {
  const long whole = static_cast<long>(std::clamp(seconds, 0.0, 1e9));
  char text[40];
  if (whole < 3600)
    std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  else
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  return text;
}

ProgressBar::ProgressBar(bool quiet) : visible_(!quiet && ::isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() { clear(); }

Progress ProgressBar::watch() {
  if (!visible_) return {};
  return [this](const char* stage, double done) { show(stage, done, {}); };
}

void ProgressBar::show(const std::string& label, double done, const std::string& note) {
  if (!visible_) return;
  const std::lock_guard lock(guard_);
  const Clock::time_point now = Clock::now();
  if (drawn_ && now - last_ < least_pause && label == stage_) return;
  if (label != stage_) stage_start_ = now;
  stage_ = label;
  last_ = now;
  drawn_ = true;
  const std::string line = label + "  " + draw_bar(done) + (note.empty() ? time_note(done) : note);
  std::cerr << "\r\x1b[K" << line.substr(0, terminal_width() - 1) << std::flush;
}

std::string ProgressBar::time_note(double done) const {
  const double spent = std::chrono::duration<double>(Clock::now() - stage_start_).count();
  return to_clock(spent) + (done > 0.01 ? ", " + to_clock(spent * (1 - done) / done) + " left" : "");
}

void ProgressBar::clear() {
  const std::lock_guard lock(guard_);
  if (drawn_) std::cerr << "\r\x1b[K" << std::flush;
  drawn_ = false;
}

double ProgressBar::seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

} // namespace domewarp
