// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "lucerna/progress.h"

namespace lucerna::python {

namespace py = pybind11;

/// Whether this process was forked after another one ran parallel loops: their threads are not in it.
bool is_forked();

/// A call that may run parallel loops, or leave the interpreter's lock. Made and gone with the lock held.
/// Making one is a RuntimeError in a process that was forked, and at the end of the interpreter: a thread
/// that came back after it would end the process.
class Call {
 public:
  Call();
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
};

/// At the interpreter's exit long calls of other threads are asked to stop, and all are waited for.
void end_calls_at_exit();

/// Calls `work` without the interpreter's lock: for calls that may take a millisecond.
template <class Work>
auto released(Work&& work) {
  const Call call;
  const py::gil_scoped_release unlocked;
  return std::forward<Work>(work)();
}

/// What a long call has reported last. The library's threads write it, Python's thread reads it.
class Watch final : public Progress {
 public:
  Watch();
  ~Watch() override;
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  void update(std::string_view phase, std::uint64_t done, std::uint64_t total) override;
  bool stop_requested() const override;
  void stop() { stop_ = true; }
  /// Whether the work has been told to stop, so that its result may be less than what was asked for.
  bool was_noticed() const { return noticed_; }

  /// Fills in what the callback's argument has besides, under the lock; for reports that are no Progress.
  void note(std::function<void(py::dict&)> more);
  /// The argument of the callback, if there is something new.
  std::optional<py::object> news();

 private:
  std::atomic<bool> stop_ = false;
  mutable std::atomic<bool> noticed_ = false;
  std::mutex mutex_;
  bool is_new_ = false;
  std::string phase_;
  std::uint64_t done_ = 0, total_ = 0;
  std::function<void(py::dict&)> more_;
};

/// What happens to a result that is there when the user pressed Ctrl-C.
enum class OnInterrupt { raise, keep };

/// Runs `work` on a thread of its own, without the interpreter's lock, and meanwhile handles signals and
/// calls `callback` (None: nothing) ten times a second, and at the end. Ctrl-C and an exception of the
/// callback ask the work to stop; the latter is raised then, the former only with OnInterrupt::raise, where
/// the work has no result or where it came to its end all the same.
void run_watched(const py::object& callback, OnInterrupt on_interrupt,
                 const std::function<void(Watch&)>& work);

/// The same with a result.
template <class Work>
auto watched(const py::object& callback, OnInterrupt on_interrupt, Work&& work) {
  std::optional<std::invoke_result_t<Work, Watch&>> result;
  run_watched(callback, on_interrupt, [&](Watch& watch) { result.emplace(work(watch)); });
  return std::move(*result);
}

}  // namespace lucerna::python
