// SPDX-License-Identifier: Apache-2.0
#define LUCERNA_SCALAR
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include "lucerna/trace/device/accelerator.h"
#include "lucerna/trace/kernels/trace_kernel.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

class EmulatedAccelerator final : public Accelerator {
 public:
  std::string name() const override { return "emulated"; }
  std::string isa() const override { return "emulated"; }
  /// Few, so that short tests use every stream again.
  std::uint32_t chunk_blocks() const override { return 16; }

  void* allocate(std::size_t bytes) override {
    // What is not written first must show: no number in here is one by chance.
    void* const p = allocate_host(bytes);
    std::memset(p, 0xff, bytes);
    return p;
  }
  void release(void* device) noexcept override { std::free(device); }
  void* allocate_host(std::size_t bytes) override {
    void* const p = std::malloc(bytes);
    if (p == nullptr) throw std::bad_alloc();
    return p;
  }
  void release_host(void* host) noexcept override { std::free(host); }

  void upload(int, void* device, const void* host, std::size_t bytes) override { copy(device, host, bytes); }
  void download(int, void* host, const void* device, std::size_t bytes) override {
    copy(host, device, bytes);
  }
  void fill(int, void* device, unsigned char byte, std::size_t bytes) override {
    std::memset(device, byte, bytes);
  }

  void trace(int, const LaunchView& v) override {
    with_compiled(v.features, [&v](auto features) { trace_all<features.value>(v); });
  }

  void rebuild(int, const HierarchyView& h) override {
    for (int level = 0; level < h.levels; ++level) {
      const std::size_t n = static_cast<std::size_t>(h.cells / kFieldBlock) >> level;
      for (std::size_t i = 0; i < n * n; ++i) rebuild_node(h, level, i);
    }
    *h.bounds = no_bounds();
    const std::size_t blocks = static_cast<std::size_t>(h.cells / kFieldBlock);
    for (std::size_t i = 0; i < blocks * blocks; ++i) widen(*h.bounds, h, i);
  }

  void* native_stream(int) const override { return nullptr; }
  void wait(int) override {}

 private:
  /// Nothing may come from or go to nowhere, as an empty vector's data.
  static void copy(void* to, const void* from, std::size_t bytes) {
    if (bytes > 0) std::memcpy(to, from, bytes);
  }

  template <SceneFeatures kFeatures>
  static void trace_all(const LaunchView& v) {
    for (std::size_t block = 0; block < v.blocks; ++block) {
      Counters counters;
      for (std::uint32_t k = 0; k < kBlockRays; ++k) trace_number<kFeatures>(v, block, k, counters);
      std::int64_t* const ledger = v.ledger + (v.first_block + block) % kReplicates * kLedgerSums;
      for (int i = 0; i < kLedgerSums; ++i) atomic_add(ledger + i, counters.sum[i]);
    }
  }
};

}  // namespace

std::unique_ptr<Accelerator> make_emulated_accelerator() { return std::make_unique<EmulatedAccelerator>(); }

}  // namespace lucerna
