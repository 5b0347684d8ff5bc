// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>

#include "lucerna/trace/device/accelerator.h"

namespace lucerna {

/// Memory of an accelerator, or memory of the CPU that it copies fast from and to; released with its owner.
class AcceleratorBuffer {
 public:
  AcceleratorBuffer() = default;
  AcceleratorBuffer(Accelerator& accelerator, std::size_t bytes, bool on_host = false)
      : accelerator_(&accelerator),
        data_(on_host ? accelerator.allocate_host(bytes) : accelerator.allocate(bytes)),
        bytes_(bytes),
        on_host_(on_host) {}
  AcceleratorBuffer(AcceleratorBuffer&& other) noexcept { *this = std::move(other); }
  AcceleratorBuffer& operator=(AcceleratorBuffer&& other) noexcept {
    std::swap(accelerator_, other.accelerator_);
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    std::swap(on_host_, other.on_host_);
    return *this;
  }
  AcceleratorBuffer(const AcceleratorBuffer&) = delete;
  AcceleratorBuffer& operator=(const AcceleratorBuffer&) = delete;
  ~AcceleratorBuffer() {
    if (data_ == nullptr) return;
    on_host_ ? accelerator_->release_host(data_) : accelerator_->release(data_);
  }

  template <class T>
  T* as() const {
    return static_cast<T*>(data_);
  }
  std::size_t bytes() const { return bytes_; }

 private:
  Accelerator* accelerator_ = nullptr;
  void* data_ = nullptr;
  std::size_t bytes_ = 0;
  bool on_host_ = false;
};

}  // namespace lucerna
