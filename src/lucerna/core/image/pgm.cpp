// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/image/pgm.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxPgmBytes = std::uint64_t{1} << 28;
constexpr std::uint64_t kMaxPgmPixels = std::uint64_t{1} << 24;

/// The numbers of a PGM file; comments run from # to the end of the line.
class PgmReader {
 public:
  explicit PgmReader(const std::filesystem::path& path)
      : file_(path.string()), bytes_(read_file(path, kMaxPgmBytes)) {}

  GreyImage read() {
    const std::string_view kind = std::string_view(bytes_).substr(0, 2);
    if (kind != "P5" && kind != "P2") fail("this is no PGM: expected P5 or P2");
    at_ = 2;
    GreyImage image;
    image.width = number(1, kMaxPgmPixels);
    image.height = number(1, kMaxPgmPixels);
    if (image.height > kMaxPgmPixels / image.width)
      fail("{} x {} pixels, expected at most {}", image.width, image.height, kMaxPgmPixels);
    const std::uint64_t white = number(1, 65535);
    image.white = static_cast<double>(white);
    const std::size_t n = image.width * image.height;
    const std::size_t each = white > 255 ? 2 : 1;
    if (kind == "P5") ++at_;  // one white space ends the header
    const std::size_t min = kind == "P5" ? n * each : 2 * n - 1;
    if (at_ > bytes_.size() || bytes_.size() - at_ < min) fail("the file ends before its {} pixels", n);
    image.value.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      std::uint64_t value = 0;
      for (std::size_t k = 0; kind == "P5" && k < each; ++k)
        value = value << 8 | static_cast<unsigned char>(bytes_[at_++]);
      if (kind == "P2") value = number(0, white);
      if (value > white) fail("found {}, expected at most {}", value, white);
      image.value[i] = static_cast<double>(value) / image.white;
    }
    return image;
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, fmt::format("byte {}", at_), text, std::forward<Args>(args)...);
  }

  void skip() {
    while (at_ < bytes_.size()) {
      const char c = bytes_[at_];
      if (c == '#') {
        at_ = std::min(bytes_.find('\n', at_), bytes_.size());
      } else if (c == ' ' || (c >= '\t' && c <= '\r')) {
        ++at_;
      } else {
        return;
      }
    }
  }

  std::uint64_t number(std::uint64_t min, std::uint64_t max) {
    skip();
    std::uint64_t value = 0;
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9' && value <= max)
      value = 10 * value + static_cast<std::uint64_t>(bytes_[at_++] - '0');
    if (at_ == begin || value < min || value > max) {
      fail("found '{}', expected a whole number from {} to {}", bytes_.substr(begin, 12), min, max);
    }
    return value;
  }

  std::string file_, bytes_;
  std::size_t at_ = 0;
};

}  // namespace

GreyImage read_pgm(const std::filesystem::path& path) { return PgmReader(path).read(); }

}  // namespace lucerna
