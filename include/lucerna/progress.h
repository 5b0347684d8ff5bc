// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "lucerna/error.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// What a long call tells its caller, and how the caller stops it. The library itself never prints.
/// Calls may come from any thread, one at a time per phase.
class Progress {
 public:
  virtual ~Progress() = default;

  /// `done` of `total` units of `phase` are finished ("trace", "compress: octree"); total 0 = unknown.
  virtual void update(std::string_view phase, std::uint64_t done, std::uint64_t total) = 0;

  /// True once the caller wants the work to end; the long call then throws `Interrupted` at its next safe
  /// place.
  [[nodiscard]] virtual bool stop_requested() const = 0;

  /// Reports and stops if asked: what a loop calls between its blocks.
  void step(std::string_view phase, std::uint64_t done, std::uint64_t total) {
    update(phase, done, total);
    if (stop_requested()) throw Interrupted();
  }
};

/// Says nothing and never stops: the default of every long call.
class NoProgress final : public Progress {
 public:
  void update(std::string_view, std::uint64_t, std::uint64_t) override {}
  [[nodiscard]] bool stop_requested() const override { return false; }
};

/// A NoProgress that default arguments may refer to.
inline Progress& no_progress() {
  static NoProgress none;
  return none;
}

}  // namespace lucerna
#pragma GCC visibility pop
