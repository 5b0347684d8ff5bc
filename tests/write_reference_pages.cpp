// SPDX-License-Identifier: Apache-2.0
// Writes docs/reference/{cli,errors,project-file,result-json}.md: `make reference`. A test compares them.
#include "lucerna/cli/manual/reference_pages.h"
#include "lucerna/core/io/file.h"
#include "tests/support/paths.h"

int main() {
  const auto folder = lucerna::test::source_dir() / "docs/reference";
  std::filesystem::create_directories(folder);
  for (const auto& [name, text] : lucerna::cli::reference_pages()) lucerna::write_file(folder / name, text);
}
