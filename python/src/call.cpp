// SPDX-License-Identifier: Apache-2.0
#include "call.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <stdexcept>
#include <thread>

#include "record.h"

namespace lucerna::python {

namespace {

/// Between two looks at signals, and two calls of a callback.
constexpr std::chrono::milliseconds kInterval{100};

}  // namespace

void check_not_forked() {
  static std::atomic<pid_t> user = 0;
  const pid_t self = ::getpid();
  pid_t none = 0;
  if (user.compare_exchange_strong(none, self) || none == self) return;
  throw std::runtime_error(
      "lucerna was used before this process was forked, and its threads are not in it; expected a process "
      "started by the method 'spawn' or 'forkserver' (multiprocessing.get_context)");
}

void Watch::update(std::string_view phase, std::uint64_t done, std::uint64_t total) {
  const std::lock_guard lock(mutex_);
  phase_ = phase;
  done_ = done;
  total_ = total;
  is_new_ = true;
}

void Watch::note(std::function<void(py::dict&)> more) {
  const std::lock_guard lock(mutex_);
  more_ = std::move(more);
  is_new_ = true;
}

std::optional<py::object> Watch::news() {
  py::dict fields;
  const std::lock_guard lock(mutex_);
  if (!std::exchange(is_new_, false)) return std::nullopt;
  fields["phase"] = phase_;
  fields["done"] = done_;
  fields["total"] = total_;
  if (more_) more_(fields);
  return record(fields);
}

namespace {

/// Signals, then the callback. Throws what they raise.
void attend(const py::object& callback, Watch& watch, bool& called) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (callback.is_none()) return;
  if (const std::optional<py::object> news = watch.news()) {
    called = true;
    callback(*news);
  }
}

}  // namespace

void run_watched(const py::object& callback, OnInterrupt on_interrupt,
                 const std::function<void(Watch&)>& work) {
  check_not_forked();
  Watch watch;
  std::mutex mutex;
  std::condition_variable finished;
  bool done = false, called = false;
  std::exception_ptr failure;
  std::thread worker([&] {
    try {
      work(watch);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    done = true;
    finished.notify_one();
  });
  std::optional<py::error_already_set> raised;
  for (bool ended = false; !ended;) {
    {
      const py::gil_scoped_release unlocked;
      std::unique_lock lock(mutex);
      ended = finished.wait_for(lock, kInterval, [&] { return done; });
    }
    if (raised || (ended && called)) continue;
    try {
      attend(callback, watch, called);
    } catch (py::error_already_set& error) {
      raised.emplace(std::move(error));
      watch.stop();
    }
  }
  {
    const py::gil_scoped_release unlocked;
    worker.join();
  }
  if (raised && (failure || on_interrupt == OnInterrupt::raise || !raised->matches(PyExc_KeyboardInterrupt)))
    throw std::move(*raised);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace lucerna::python
