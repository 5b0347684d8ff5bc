// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/codec/range_coder.h"

#include <utility>

namespace lucerna {

namespace {
constexpr std::uint32_t kTop = 1u << 24;
}

void RangeEncoder::bit(AdaptiveBit& model, bool one) {
  const std::uint32_t bound = (range_ >> 16) * model.zero();
  if (one) {
    low_ += bound;
    range_ -= bound;
  } else {
    range_ = bound;
  }
  model.learn(one);
  while (range_ < kTop) {
    range_ <<= 8;
    shift_low();
  }
}

void RangeEncoder::shift_low() {
  if (low_ < 0xFF000000u || low_ > 0xFFFFFFFFu) {
    const auto carry = static_cast<std::uint8_t>(low_ >> 32);
    for (std::uint8_t byte = cache_; pending_ > 0; --pending_, byte = 0xFF) {
      bytes_.push_back(static_cast<char>(static_cast<std::uint8_t>(byte + carry)));
    }
    cache_ = static_cast<std::uint8_t>(low_ >> 24);
  }
  ++pending_;
  low_ = (low_ & 0x00FFFFFFu) << 8;
}

std::string RangeEncoder::finish() {
  for (int i = 0; i < 5; ++i) shift_low();
  return std::move(bytes_);
}

RangeDecoder::RangeDecoder(std::string_view bytes) : bytes_(bytes) {
  for (int i = 0; i < 5; ++i) code_ = code_ << 8 | next();
}

bool RangeDecoder::bit(AdaptiveBit& model) {
  const std::uint32_t bound = (range_ >> 16) * model.zero();
  const bool one = code_ >= bound;
  if (one) {
    code_ -= bound;
    range_ -= bound;
  } else {
    range_ = bound;
  }
  model.learn(one);
  while (range_ < kTop) {
    code_ = code_ << 8 | next();
    range_ <<= 8;
  }
  return one;
}

}  // namespace lucerna
