// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/byte_stream.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr std::size_t kPackedPart = 1 << 16;
/// RFC 1951: 258 bytes for two bits at best.
constexpr std::uint64_t kMostUnpacked = 1032;
/// zlib: the largest window, and a gzip header.
constexpr int kGzipWindow = 15 + 16;

}  // namespace

bool is_gzip(const InputFile& file) {
  std::array<std::byte, 2> head{};
  if (file.size() < head.size()) return false;
  file.read_at(0, head);
  return head[0] == std::byte{0x1F} && head[1] == std::byte{0x8B};
}

struct ByteStream::Unpacker {
  Unpacker() { LUCERNA_CHECK(inflateInit2(&zlib, kGzipWindow) == Z_OK, "zlib {}", zlibVersion()); }
  ~Unpacker() { inflateEnd(&zlib); }
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;

  z_stream zlib{};
  std::array<std::byte, kPackedPart> packed;
  std::uint64_t fed = 0;  // bytes of the file
  bool between_members = false;
};

ByteStream::ByteStream(InputFile file) : file_(std::move(file)) {
  if (is_gzip(file_)) unpacker_ = std::make_unique<Unpacker>();
}
ByteStream::~ByteStream() = default;
ByteStream::ByteStream(ByteStream&&) noexcept = default;

std::uint64_t ByteStream::most_left() const {
  return is_packed() ? kMostUnpacked * file_.size() : file_.size() - position_;
}

std::size_t ByteStream::read(std::span<std::byte> out) {
  std::size_t got = 0;
  if (is_packed()) {
    got = unpack(out);
  } else {
    got = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), most_left()));
    if (got > 0) file_.read_at(position_, out.first(got));
  }
  position_ += got;
  return got;
}

bool ByteStream::feed() {
  Unpacker& u = *unpacker_;
  const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(kPackedPart, file_.size() - u.fed));
  if (n == 0) return false;
  file_.read_at(u.fed, std::span(u.packed).first(n));
  u.fed += n;
  u.zlib.next_in = reinterpret_cast<Bytef*>(u.packed.data());
  u.zlib.avail_in = static_cast<uInt>(n);
  return true;
}

std::size_t ByteStream::unpack(std::span<std::byte> out) {
  Unpacker& u = *unpacker_;
  std::size_t got = 0;
  while (got < out.size() && fault_.empty()) {
    if (u.zlib.avail_in == 0 && !feed()) {
      if (!u.between_members)
        fault_ = fmt::format("the packed data end at byte {} of the file, before the end of the gzip stream",
                             file_.size());
      break;
    }
    if (u.between_members) inflateReset(&u.zlib);
    const auto room = static_cast<uInt>(std::min<std::size_t>(out.size() - got, 1U << 30));
    u.zlib.next_out = reinterpret_cast<Bytef*>(out.data() + got);
    u.zlib.avail_out = room;
    const int status = inflate(&u.zlib, Z_NO_FLUSH);
    got += room - u.zlib.avail_out;
    u.between_members = status == Z_STREAM_END;
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) {
      fault_ = fmt::format("the packed data are damaged before byte {} of the file ({})",
                           u.fed - u.zlib.avail_in, u.zlib.msg != nullptr ? u.zlib.msg : "zlib");
    }
  }
  return got;
}

}  // namespace lucerna
