// SPDX-License-Identifier: Apache-2.0
// Writes what is installed beside the program: lucerna_manual FOLDER makes man1/*.1 and lucerna.bash in it.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "lucerna/cli/manual/bash_completion.h"
#include "lucerna/cli/manual/manual_pages.h"
#include "lucerna/core/io/file.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder / "man1");
    for (const lucerna::cli::ManualPage& page : lucerna::cli::manual_pages())
      lucerna::write_file(folder / "man1" / page.name, page.text);
    lucerna::write_file(folder / "lucerna.bash", lucerna::cli::bash_completion());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
