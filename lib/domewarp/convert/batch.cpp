// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/batch.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <numeric>
#include <optional>
#include <set>
#include <system_error>
#include <thread>

#include "domewarp/convert/display.h"
#include "domewarp/convert/fingerprint.h"
#include "domewarp/convert/memory_estimate.h"
#include "domewarp/convert/stamp.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/core/memory.h"
#include "domewarp/core/parallel.h"
#include "domewarp/gltf/survey.h"

namespace domewarp {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Removes what write_file of a killed run has left beside these outputs: their names and six characters more.
void remove_leftovers(const fs::path& out, const std::vector<BatchItem>& items) {
  std::set<std::string> ours;
  for (const BatchItem& item : items) {
    ours.insert((out / item.output).string());
    ours.insert((out / item.output).replace_extension(".bin").string());
    ours.insert(stamp_path(out, item.output).string());
  }
  constexpr std::size_t suffix = 7;
  std::error_code status;
  std::vector<fs::path> leftovers;
  for (fs::recursive_directory_iterator entry(out, status), end; !status && entry != end; entry.increment(status)) {
    const std::string name = entry->path().string();
    if (name.size() > suffix && name[name.size() - suffix] == '.' && ours.contains(name.substr(0, name.size() - suffix))) leftovers.push_back(entry->path());
  }
  for (const fs::path& path : leftovers) fs::remove(path, status);
}

void describe(const ConvertReport& report, const ConvertOptions& options, BatchRow& row) {
  row.triangles_in = report.refine.triangles_in;
  row.triangles_out = report.refine.triangles_out;
  row.error_px = report.refine.error_px_max;
  row.tolerance_px = options.refine.tolerance_px;
  row.warnings = report.warnings;
  row.status = BatchStatus::converted;
  if (is_kept(report, options)) return;
  row.status = BatchStatus::unkept;
  row.message = broken_promise(report, options);
}

BatchStatus status_of(ErrorCode code) {
  if (code == ErrorCode::output) return BatchStatus::unwritten;
  return code == ErrorCode::unkept ? BatchStatus::unkept : BatchStatus::failed;
}

/// Deals out the scenes so that those that run at once fit into memory.
class Scheduler {
public:
  struct Task {
    std::size_t item = 0;
    double bytes = 0;       ///< of the input, for the time left
    double memory = 0;      ///< estimated
    bool alone = false;     ///< nothing else may run beside it
  };

  Scheduler(std::vector<Task> tasks, double max_memory) : waiting_(std::move(tasks)), max_memory_(max_memory) {
    std::sort(waiting_.begin(), waiting_.end(), [](const Task& a, const Task& b) { return a.bytes != b.bytes ? a.bytes > b.bytes : a.item < b.item; });
  }

  /// The next task, when there is room for it; nothing when all is done.
  std::optional<Task> take() {
    std::unique_lock lock(guard_);
    for (;;) {
      const auto next = std::find_if(waiting_.begin(), waiting_.end(), [&](const Task& task) { return fits(task); });
      if (next != waiting_.end()) {
        const Task task = *next;
        waiting_.erase(next);
        ++running_;
        reserved_ += task.memory;
        exclusive_ = task.alone;
        return task;
      }
      if (waiting_.empty() && running_ == 0) return std::nullopt;
      room_.wait(lock);
    }
  }

  void finish(const Task& task) {
    const std::lock_guard lock(guard_);
    release(task);
  }

  /// Puts a task back, to run when nothing else does.
  void retry_alone(Task task) {
    const std::lock_guard lock(guard_);
    release(task);
    task.alone = true;
    waiting_.push_back(task);
  }

private:
  bool fits(const Task& task) const {
    if (running_ == 0) return true;
    return !task.alone && !exclusive_ && (max_memory_ == 0 || reserved_ + task.memory <= max_memory_);
  }

  void release(const Task& task) {
    --running_;
    reserved_ -= task.memory;
    exclusive_ = false;
    room_.notify_all();
  }

  std::mutex guard_;
  std::condition_variable room_;
  std::vector<Task> waiting_;
  double max_memory_, reserved_ = 0;
  int running_ = 0;
  bool exclusive_ = false;
};

class Batch {
public:
  Batch(const std::vector<BatchItem>& items, const BatchOptions& options, const BatchWatch& watch)
      : items_(items), options_(options), watch_(watch) {
    report_.rows.resize(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
      report_.rows[i].input = items[i].input;
      report_.rows[i].output = items[i].output;
    }
  }

  BatchReport run() {
    make_folder(options_.out);
    remove_leftovers(options_.out, items_);
    find_up_to_date();
    std::vector<Scheduler::Task> tasks = make_tasks();
    report_.jobs = std::min(processors_or(options_.jobs), std::max(static_cast<int>(tasks.size()), 1));
    threads_ = std::max(1, processors_or(0) / report_.jobs);
    Scheduler scheduler(std::move(tasks), static_cast<double>(options_.max_memory));
    std::vector<std::jthread> workers;
    const auto take_turns = [&] {
      while (const auto task = scheduler.take()) work(scheduler, *task);
    };
    try {
      while (static_cast<int>(workers.size()) + 1 < report_.jobs) workers.emplace_back(take_turns);
    } catch (const std::system_error&) { // no room for another thread: those that are there do the work
    }
    take_turns();
    workers.clear(); // joins
    report_.seconds = seconds_since(start_);
    report_.peak_memory_mb = static_cast<double>(peak_memory()) / (1 << 20);
    return std::move(report_);
  }

private:
  static int processors_or(int jobs) { return jobs > 0 ? jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

  void find_up_to_date() {
    if (options_.force) return;
    std::vector<char> found(items_.size());
    parallel_each(items_.size(), 1, [&](std::size_t i) {
      std::error_code status;
      if (!fs::exists(stamp_path(options_.out, items_[i].output), status)) return;
      try {
        if (auto row = read_stamp(options_.out, items_[i].output, fingerprint(items_[i]))) {
          row->input = items_[i].input;
          report_.rows[i] = std::move(*row);
          found[i] = true;
        }
      } catch (const Error&) { // the conversion will say what is wrong
      }
    });
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (found[i]) finish(i, 0);
  }

  /// What remains to be done; scenes that cannot fit are refused here.
  std::vector<Scheduler::Task> make_tasks() {
    std::vector<Scheduler::Task> tasks;
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (!report_.rows[i].up_to_date) tasks.push_back({i, 0, 0, false});
    parallel_each(tasks.size(), 1, [&](std::size_t i) {
      const BatchItem& item = items_[tasks[i].item];
      const FileSurvey survey = survey_file(item.input, item.options->read.allow_external);
      tasks[i].bytes = survey.file_bytes;
      tasks[i].memory = estimate_memory(survey, item.options->convert);
    });
    for (const Scheduler::Task& task : tasks) total_bytes_ += task.bytes;
    std::erase_if(tasks, [&](const Scheduler::Task& task) {
      const std::string why = memory_refusal(task.memory, options_.max_memory);
      if (why.empty()) return false;
      refuse(task.item, why);
      finish(task.item, task.bytes);
      return true;
    });
    return tasks;
  }

  void refuse(std::size_t item, const std::string& why) {
    report_.rows[item].status = BatchStatus::refused;
    report_.rows[item].message = items_[item].input.string() + ": " + why;
  }

  void work(Scheduler& scheduler, const Scheduler::Task& task) {
    const Clock::time_point start = Clock::now();
    BatchRow& row = report_.rows[task.item];
    try {
      with_threads(threads_, [&] { convert_item(items_[task.item], row, start); });
    } catch (const Error& error) {
      row.status = status_of(error.code());
      row.message = error.what();
    } catch (const std::bad_alloc&) {
      release_free_memory();
      if (!task.alone) return scheduler.retry_alone(task);
      refuse(task.item, memory_exhausted(options_.max_memory));
    } catch (const std::exception& error) {
      row.status = BatchStatus::failed;
      row.message = row.input.string() + ": " + error.what();
    }
    if (options_.max_memory > 0) release_free_memory();
    row.seconds = seconds_since(start);
    finish(task.item, task.bytes);
    scheduler.finish(task);
  }

  void convert_item(const BatchItem& item, BatchRow& row, Clock::time_point start) {
    const std::string print = fingerprint(item);
    const fs::path output = options_.out / item.output;
    make_folder(output.parent_path());
    JobOptions job = *item.options;
    if (options_.max_memory > 0) job.read.max_bytes = std::min<std::size_t>(job.read.max_bytes, options_.max_memory);
    describe(run_job(item.input, output, job, &displays_), job.convert, row);
    row.seconds = seconds_since(start);
    write_stamp(options_.out, row, print);
  }

  void finish(std::size_t item, double bytes) {
    const std::lock_guard lock(guard_);
    BatchRow& row = report_.rows[item];
    if (!row.message.empty() && !row.message.starts_with(row.input.string())) row.message.insert(0, row.input.string() + ": ");
    done_bytes_ += bytes;
    ++done_;
    if (watch_) watch_(row, {done_, items_.size(), total_bytes_ > 0 ? done_bytes_ / total_bytes_ : 0});
  }

  const std::vector<BatchItem>& items_;
  const BatchOptions& options_;
  const BatchWatch& watch_;
  const Clock::time_point start_ = Clock::now();
  BatchReport report_;
  DisplayCache displays_;
  int threads_ = 1;
  std::mutex guard_;
  std::size_t done_ = 0;
  double done_bytes_ = 0, total_bytes_ = 0;
};

} // namespace

BatchReport run_batch(const std::vector<BatchItem>& items, const BatchOptions& options, const BatchWatch& watch) {
  return Batch(items, options, watch).run();
}

int exit_code(const BatchReport& report) {
  for (const ErrorCode code : {ErrorCode::output, ErrorCode::unkept, ErrorCode::input})
    for (const BatchRow& row : report.rows)
      if (exit_code(row.status) == static_cast<int>(code)) return static_cast<int>(code);
  return 0;
}

} // namespace domewarp
