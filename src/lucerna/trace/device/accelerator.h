// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lucerna/trace/kernels/launch_view.h"

namespace lucerna {

/// Something with a memory of its own that runs the kernels of trace_kernel.h: a CUDA device, or the CPU in
/// its place. Work given to one stream is done in order; streams run beside each other and the caller. Not
/// thread safe: one thread drives one accelerator. Errors of the device are InputErrors that name it.
class Accelerator {
 public:
  virtual ~Accelerator() = default;

  /// For people: "NVIDIA H200 (sm_90)".
  virtual std::string name() const = 0;
  /// What TraceResult::isa says: results of different ones are not to be added.
  virtual std::string isa() const = 0;

  /// Blocks of kBlockRays rays that a launch should have: long beside the start of a kernel, small beside the
  /// memory.
  virtual std::uint32_t chunk_blocks() const = 0;

  virtual void* allocate(std::size_t bytes) = 0;
  virtual void release(void* device) noexcept = 0;
  /// Memory of the CPU that copies are fast from and to.
  virtual void* allocate_host(std::size_t bytes) = 0;
  virtual void release_host(void* host) noexcept = 0;

  static constexpr int kStreams = 3;
  virtual void upload(int stream, void* device, const void* host, std::size_t bytes) = 0;
  virtual void download(int stream, void* host, const void* device, std::size_t bytes) = 0;
  /// Sets every byte.
  virtual void fill(int stream, void* device, unsigned char byte, std::size_t bytes) = 0;

  /// Traces all rays of the launch.
  virtual void trace(int stream, const LaunchView& launch) = 0;
  /// Makes nodes and band from the vertices.
  virtual void rebuild(int stream, const HierarchyView& hierarchy) = 0;
  /// The device's own name of a stream (a cudaStream_t), for kernels of other folders; null where the CPU
  /// stands in: then they run at once.
  virtual void* native_stream(int stream) const = 0;
  /// Returns when all work of the stream is done.
  virtual void wait(int stream) = 0;
};

/// The CPU in a GPU's place: the same kernels from the same headers, one index after the other. For tests.
std::unique_ptr<Accelerator> make_emulated_accelerator();

/// All CUDA devices that this program can run on; none when it was built without CUDA, or the machine has no
/// driver or no device.
std::vector<std::unique_ptr<Accelerator>> cuda_accelerators();
/// One line that says why cuda_accelerators() is empty; empty where it is not.
std::string cuda_unavailable_reason();
/// Throws InputError, saying why, where there is no CUDA device.
void require_cuda();

}  // namespace lucerna
