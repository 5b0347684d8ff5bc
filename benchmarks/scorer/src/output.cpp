// SPDX-License-Identifier: Apache-2.0
#include "output.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <system_error>

#include "error.h"

namespace bench {

void write_whole(const std::string& file, const std::string& text) {
  const std::string temporary = file + ".part" + std::to_string(getpid());
  std::error_code failed;
  {
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    out.close();
    if (!out) failed = std::make_error_code(std::errc::io_error);
  }
  if (!failed) std::filesystem::rename(temporary, file, failed);
  if (!failed) return;
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  throw InputError(file, "file", "a place that cannot be written", "one that can");
}

}  // namespace bench
