// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace lucerna {

/// The probability of a 0, learned from the bits coded with it: the mean of a fast and a slow estimate.
class AdaptiveBit {
 public:
  /// Of 2^16; 1 .. 65535.
  std::uint32_t zero() const {
    const std::uint32_t p = (std::uint32_t{fast_} + slow_) >> 1;
    return p < 32 ? 32 : p > 65504 ? 65504 : p;
  }
  void learn(bool one) {
    fast_ = static_cast<std::uint16_t>(one ? fast_ - (fast_ >> 4) : fast_ + ((65535 - fast_) >> 4));
    slow_ = static_cast<std::uint16_t>(one ? slow_ - (slow_ >> 7) : slow_ + ((65535 - slow_) >> 7));
  }

 private:
  std::uint16_t fast_ = 32768, slow_ = 32768;
};

/// Binary arithmetic coding with adaptive probabilities: the carry-propagating range coder of G. N. N. Martin
/// ("Range encoding", 1979) in the 32-bit form that LZMA made common.
class RangeEncoder {
 public:
  void bit(AdaptiveBit& model, bool one);
  /// The bytes; the encoder is spent.
  std::string finish();

 private:
  void shift_low();
  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFu;
  std::uint8_t cache_ = 0;
  std::uint64_t pending_ = 1;
  std::string bytes_;
};

/// The inverse. Bytes that were never written give some bits or other; `overrun` says that more bytes were
/// asked for than there are.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::string_view bytes);
  bool bit(AdaptiveBit& model);
  bool overrun() const { return at_ > bytes_.size(); }

 private:
  std::uint8_t next() {
    const std::size_t i = at_++;
    return i < bytes_.size() ? static_cast<std::uint8_t>(bytes_[i]) : std::uint8_t{0};
  }
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::uint32_t code_ = 0, range_ = 0xFFFFFFFFu;
};

/// Codes a number < 2^Bits, high bits first, each with the bits before it as context.
template <unsigned Bits>
class AdaptiveSymbol {
 public:
  void encode(RangeEncoder& coder, std::uint32_t x) {
    std::uint32_t node = 1;
    for (unsigned i = Bits; i-- > 0;) {
      const bool one = (x >> i & 1u) != 0;
      coder.bit(bits_[node], one);
      node = node << 1 | (one ? 1u : 0u);
    }
  }
  std::uint32_t decode(RangeDecoder& coder) {
    std::uint32_t node = 1;
    for (unsigned i = 0; i < Bits; ++i) node = node << 1 | (coder.bit(bits_[node]) ? 1u : 0u);
    return node - (1u << Bits);
  }

 private:
  std::array<AdaptiveBit, std::size_t{1} << Bits> bits_{};
};

}  // namespace lucerna
