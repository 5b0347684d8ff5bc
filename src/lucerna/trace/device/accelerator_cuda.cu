// SPDX-License-Identifier: Apache-2.0
// The kernels of trace_kernel.h on CUDA devices. What a thread does is in the shared headers; here are
// memory, streams, launches and the sums over a block of threads.
#include <cuda_runtime.h>

#include <cfloat>

#include "lucerna/trace/device/accelerator.h"
#include "lucerna/trace/device/accelerator_error.h"
#include "lucerna/trace/device/block_sums.cuh"
#include "lucerna/trace/kernels/trace_kernel.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// Threads of a block; each traces kBlockRays / kThreads rays of one block of numbers, so all belong to one
/// replicate.
constexpr unsigned kThreads = 128;
static_assert(kBlockRays % kThreads == 0);

template <SceneFeatures kFeatures>
__global__ void __launch_bounds__(kThreads) trace_kernel(const __grid_constant__ LaunchView v) {
  Counters counters;
  for (std::uint32_t k = threadIdx.x; k < kBlockRays; k += kThreads) {
    trace_number<kFeatures>(v, blockIdx.x, k, counters);
  }
  add_block_sums(counters.sum, kLedgerSums,
                 v.ledger + (v.first_block + blockIdx.x) % kReplicates * kLedgerSums);
}

__global__ void rebuild_level_kernel(const __grid_constant__ HierarchyView h, int level, std::size_t nodes) {
  const std::size_t i = static_cast<std::size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < nodes) rebuild_node(h, level, i);
}

/// One block of kThreads threads.
__global__ void bounds_kernel(const __grid_constant__ HierarchyView h, std::size_t leaves) {
  __shared__ double lows[kThreads], highs[kThreads], gradient_bound[kThreads];
  FieldBounds bounds = no_bounds();
  for (std::size_t i = threadIdx.x; i < leaves; i += kThreads) widen(bounds, h, i);
  lows[threadIdx.x] = bounds.low;
  highs[threadIdx.x] = bounds.high;
  gradient_bound[threadIdx.x] = bounds.gradient_bound;
  __syncthreads();
  if (threadIdx.x != 0) return;
  for (unsigned i = 1; i < kThreads; ++i) widen(bounds, {lows[i], highs[i], gradient_bound[i]});
  *h.bounds = bounds;
}

class CudaAccelerator final : public Accelerator {
 public:
  explicit CudaAccelerator(int device) : device_(device) {
    cudaDeviceProp p{};
    check(cudaGetDeviceProperties(&p, device));
    name_ = p.name;
    name_ += " (sm_" + std::to_string(10 * p.major + p.minor) + ")";
    check(cudaSetDevice(device_));
    for (cudaStream_t& s : streams_) check(cudaStreamCreateWithFlags(&s, cudaStreamNonBlocking));
  }
  ~CudaAccelerator() override {
    cudaSetDevice(device_);
    for (cudaStream_t s : streams_) cudaStreamDestroy(s);
  }

  std::string name() const override { return name_; }
  std::string isa() const override { return "cuda"; }
  std::uint32_t chunk_blocks() const override { return 2048; }

  void* allocate(std::size_t bytes) override {
    void* p = nullptr;
    check(cudaSetDevice(device_));
    check(cudaMalloc(&p, bytes));
    return p;
  }
  void release(void* device) noexcept override {
    cudaSetDevice(device_);
    cudaFree(device);  // waits for all that still uses it
  }
  void* allocate_host(std::size_t bytes) override {
    void* p = nullptr;
    check(cudaSetDevice(device_));
    check(cudaMallocHost(&p, bytes));
    return p;
  }
  void release_host(void* host) noexcept override {
    cudaSetDevice(device_);
    cudaDeviceSynchronize();
    cudaFreeHost(host);
  }

  void upload(int stream, void* device, const void* host, std::size_t bytes) override {
    check(cudaSetDevice(device_));
    check(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, streams_[stream]));
  }
  void download(int stream, void* host, const void* device, std::size_t bytes) override {
    check(cudaSetDevice(device_));
    check(cudaMemcpyAsync(host, device, bytes, cudaMemcpyDeviceToHost, streams_[stream]));
  }
  void fill(int stream, void* device, unsigned char byte, std::size_t bytes) override {
    check(cudaSetDevice(device_));
    check(cudaMemsetAsync(device, byte, bytes, streams_[stream]));
  }

  void trace(int stream, const LaunchView& launch) override {
    if (launch.blocks == 0) return;
    check(cudaSetDevice(device_));
    with_compiled(launch.features, [&](auto features) {
      trace_kernel<features.value><<<launch.blocks, kThreads, 0, streams_[stream]>>>(launch);
    });
    check(cudaGetLastError());
  }
  void rebuild(int stream, const HierarchyView& h) override {
    check(cudaSetDevice(device_));
    std::size_t leaves = 0;
    for (int level = 0; level < h.levels; ++level) {
      const std::size_t side = static_cast<std::size_t>(h.cells / kFieldBlock) >> level, nodes = side * side;
      const auto blocks = static_cast<unsigned>((nodes + kThreads - 1) / kThreads);
      rebuild_level_kernel<<<blocks, kThreads, 0, streams_[stream]>>>(h, level, nodes);
      check(cudaGetLastError());
      if (level == 0) leaves = nodes;
    }
    bounds_kernel<<<1, kThreads, 0, streams_[stream]>>>(h, leaves);
    check(cudaGetLastError());
  }
  void* native_stream(int stream) const override { return streams_[stream]; }
  void wait(int stream) override {
    check(cudaSetDevice(device_));
    check(cudaStreamSynchronize(streams_[stream]));
  }

 private:
  void check(cudaError_t code) const {
    if (code == cudaSuccess) return;
    cudaGetLastError();  // forgets it
    throw_accelerator_error(name_.c_str(), cudaGetErrorString(code));
  }

  int device_;
  std::string name_ = "CUDA device";
  cudaStream_t streams_[kStreams] = {};
};

/// Devices there are, or why there is none.
int device_count(std::string& why) {
  int n = 0;
  const cudaError_t code = cudaGetDeviceCount(&n);
  if (code == cudaSuccess && n > 0) return n;
  cudaGetLastError();
  why = code == cudaSuccess || code == cudaErrorNoDevice ? "this machine has no CUDA device"
        : code == cudaErrorInsufficientDriver
            ? "this machine has no CUDA driver, or one older than this program needs"
            : std::string("no CUDA device can be used: ") + cudaGetErrorString(code);
  return 0;
}

}  // namespace

std::vector<std::unique_ptr<Accelerator>> cuda_accelerators() {
  std::string why;
  std::vector<std::unique_ptr<Accelerator>> all;
  const int n = device_count(why);
  for (int device = 0; device < n; ++device) all.push_back(std::make_unique<CudaAccelerator>(device));
  return all;
}

std::string cuda_unavailable_reason() {
  std::string why;
  device_count(why);
  return why;
}

}  // namespace lucerna
