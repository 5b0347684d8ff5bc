// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/file.h"

#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// Of errno.
std::string reason() { return std::strerror(errno); }

[[noreturn]] void throw_cannot_write(const std::filesystem::path& path, int error) {
  const bool full = error == ENOSPC || error == EDQUOT;
  throw InputError(fmt::format("{}: cannot write: {}", path.string(), std::strerror(error)),
                   full ? ErrorCause::no_space : ErrorCause::unwritable);
}

[[noreturn]] void throw_cannot_read(const std::string& name, int error) {
  const bool absent = error == ENOENT || error == ENOTDIR;
  throw InputError(fmt::format("{}: cannot read: {}", name, std::strerror(error)),
                   absent ? ErrorCause::not_found : ErrorCause::unreadable);
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path_, ignored)) {
    throw InputError(fmt::format("{}: cannot write: it is a directory", path_.string()),
                     ErrorCause::unwritable);
  }
  // A name of this thread's own: several may write to one path at once, and what was committed last stays.
  temporary_ = path_;
  temporary_ += fmt::format(".tmp{}-{}", ::getpid(), ::gettid());
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr) throw_cannot_write(path_, errno);
}

OutputFile::~OutputFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void OutputFile::write(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;  // whose place may be null, which fwrite must not be given
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) throw_cannot_write(path_, errno);
}

void OutputFile::patch(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (::fseeko(file_, static_cast<off_t>(offset), SEEK_SET) != 0) throw_cannot_write(path_, errno);
  write(bytes);
  if (::fseeko(file_, 0, SEEK_END) != 0) throw_cannot_write(path_, errno);
}

void OutputFile::commit() {
  std::FILE* file = std::exchange(file_, nullptr);
  // fclose also reports what a full disk refused when the buffer was flushed.
  const bool good = std::fclose(file) == 0 && std::rename(temporary_.c_str(), path_.c_str()) == 0;
  if (good) return;
  const int why = errno;
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
  throw_cannot_write(path_, why);
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

InputFile::InputFile(const std::filesystem::path& path) : name_(path.string()) {
  const auto check_kind = [this](const struct stat& status) {
    if (!S_ISREG(status.st_mode))
      throw InputError(fmt::format("{}: cannot read: not a regular file", name_), ErrorCause::unreadable);
  };
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw_cannot_read(name_, errno);
  check_kind(status);  // before it is opened: a pipe would be waited for
  file_.reset(std::fopen(path.c_str(), "rb"));
  // Another file may have taken the name in between: the size is that of the file which was opened.
  if (!file_ || ::fstat(::fileno(file_.get()), &status) != 0) throw_cannot_read(name_, errno);
  check_kind(status);
  size_ = static_cast<std::uint64_t>(status.st_size);
}

void InputFile::read_at(std::uint64_t offset, std::span<std::byte> out) const {
  if (offset > size_ || out.size() > size_ - offset) {
    throw_input_error(name_, fmt::format("byte {}", offset), "{} bytes expected, the file ends at byte {}",
                      out.size(), size_);
  }
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t got = ::pread(::fileno(file_.get()), out.data() + done, out.size() - done,
                                static_cast<off_t>(offset + done));
    if (got > 0) {
      done += static_cast<std::size_t>(got);
    } else if (got == 0) {
      throw_input_error(name_, fmt::format("byte {}", offset + done),
                        "the file became shorter while it was read");
    } else if (errno != EINTR) {
      throw_input_error(name_, fmt::format("byte {}", offset + done), "cannot read: {}", reason());
    }
  }
}

std::string lower_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending;
}

std::string read_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
  const InputFile file(path);
  if (file.size() > max_bytes) {
    throw InputError(fmt::format("{}: {} bytes, at most {} expected for a file of this kind", file.name(),
                                 file.size(), max_bytes),
                     ErrorCause::damaged);
  }
  std::string text(file.size(), '\0');
  file.read_at(0, std::as_writable_bytes(std::span(text)));
  return text;
}

std::string sha256_of_file(const std::filesystem::path& path) {
  const InputFile file(path);
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  LUCERNA_CHECK(context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1,
                "SHA-256 is not available");
  std::vector<std::byte> block(1 << 20);
  for (std::uint64_t offset = 0; offset < file.size(); offset += block.size()) {
    const std::span part(block.data(), std::min<std::uint64_t>(block.size(), file.size() - offset));
    file.read_at(offset, part);
    EVP_DigestUpdate(context.get(), part.data(), part.size());
  }
  std::array<unsigned char, 32> digest{};
  EVP_DigestFinal_ex(context.get(), digest.data(), nullptr);
  std::string hex;
  for (const unsigned char byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

}  // namespace lucerna
