// SPDX-License-Identifier: Apache-2.0
#include "call.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <set>
#include <stdexcept>
#include <thread>

#include "record.h"

namespace lucerna::python {

namespace {

/// Between two looks at signals, and two calls of a callback.
constexpr std::chrono::milliseconds kInterval{100};

/// The process that made the first call.
std::atomic<pid_t> user_pid = 0;

/// The calls of all threads. Never destroyed, for threads may outlive what is static.
struct Calls {
  std::mutex mutex;
  std::condition_variable fewer;
  std::size_t count = 0;
  bool closed = false;
  std::set<Watch*> watches;
};
Calls& calls() {
  static auto* const all = new Calls;
  return *all;
}

void end_calls() {
  if (is_forked()) return;  // threads that would end the calls are not here
  const py::gil_scoped_release unlocked;
  std::unique_lock lock(calls().mutex);
  calls().closed = true;
  for (Watch* watch : calls().watches) watch->stop();
  calls().fewer.wait(lock, [] { return calls().count == 0; });
}

}  // namespace

bool is_forked() {
  const pid_t user = user_pid;
  return user != 0 && user != ::getpid();
}

Call::Call() {
  pid_t none = 0;
  user_pid.compare_exchange_strong(none, ::getpid());
  if (is_forked())
    throw std::runtime_error(
        "lucerna was used before this process was forked, and its threads are not in it; expected a process "
        "started by the method 'spawn' or 'forkserver' (multiprocessing.get_context)");
  const std::lock_guard lock(calls().mutex);
  if (calls().closed) throw std::runtime_error("the interpreter is at its end: no call of lucerna is begun");
  ++calls().count;
}

Call::~Call() {
  const std::lock_guard lock(calls().mutex);
  --calls().count;
  calls().fewer.notify_all();
}

void end_calls_at_exit() { py::module_::import("atexit").attr("register")(py::cpp_function(&end_calls)); }

Watch::Watch() {
  const std::lock_guard lock(calls().mutex);
  calls().watches.insert(this);
}

Watch::~Watch() {
  const std::lock_guard lock(calls().mutex);
  calls().watches.erase(this);
}

bool Watch::stop_requested() const {
  if (stop_) noticed_ = true;
  return stop_;
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
void attend(const py::object& callback, Watch& watch, bool ended) {
  if (!ended && PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (callback.is_none()) return;
  if (const std::optional<py::object> news = watch.news()) callback(*news);
}

}  // namespace

void run_watched(const py::object& callback, OnInterrupt on_interrupt,
                 const std::function<void(Watch&)>& work) {
  const Call call;
  Watch watch;
  std::mutex mutex;
  std::condition_variable finished;
  bool done = false;
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
    // What is pressed after the end is for the interpreter, which raises it behind this call.
    if (raised || (ended && callback.is_none())) continue;
    try {
      attend(callback, watch, ended);
    } catch (py::error_already_set& error) {
      raised.emplace(std::move(error));
      watch.stop();
    }
  }
  {
    const py::gil_scoped_release unlocked;
    worker.join();
  }
  const auto may_be_kept = [&] {
    return on_interrupt == OnInterrupt::keep && !failure && watch.was_noticed() &&
           raised->matches(PyExc_KeyboardInterrupt);
  };
  if (raised && !may_be_kept()) throw std::move(*raised);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace lucerna::python
