// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

/// Stops the fuzzer with a finding.
inline void require(bool condition) {
  if (!condition) std::abort();
}

/// Bytes as a file that readers can open by its path; its name ends with `ending`, where readers go by that.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size, const std::string& ending = "")
      : file_(::memfd_create("fuzz", 0)) {
    require(file_ >= 0 && ::write(file_, data, size) == static_cast<ssize_t>(size));
    path_ = "/proc/self/fd/" + std::to_string(file_);
    if (ending.empty()) return;
    const std::string link = folder() + "/input" + ending;
    std::filesystem::remove(link);
    std::filesystem::create_symlink(path_, link);
    path_ = link;
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  /// One of this process, made once.
  static const std::string& folder() {
    static const std::string path = [] {
      std::string name = (std::filesystem::temp_directory_path() / "lucerna-fuzz-XXXXXX").string();
      require(::mkdtemp(name.data()) != nullptr);
      return name;
    }();
    return path;
  }
  int file_;
  std::string path_;
};
